"""One file per verb: its function ``verb`` returns the exit status, and is imported with nothing heavy at its top."""
