"""Any loop: one pass over the schedule's events, and the ledger of its works.

==========  ===================================================================================
``loop``    the events executed on the three sides
``ledger``  works of all terms, added up step by smooth step
==========  ===================================================================================
"""
