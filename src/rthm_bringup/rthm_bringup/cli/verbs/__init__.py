"""One file per verb: its function ``verb`` returns the exit status.

All of them are imported at every start, so nothing heavy is imported at their top.
"""
