"""When simulation and recording differ: where, what physics was left out, how big, how sure."""
