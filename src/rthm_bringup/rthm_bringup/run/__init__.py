"""The run of a hybrid test: start the nodes, record, stop, and say what happened."""
