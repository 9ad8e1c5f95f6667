"""Any loop: one pass over the schedule's events, and the ledger of its work.

==========  ===================================================================================
``loop``    the events executed on the three sides
``ledger``  work of all terms, added up step by smooth step
==========  ===================================================================================
"""
