"""``rthm dashboard``: a page about a running test, from a process of its own.

    watcher_node -> rthm_analysis.dashboard.RunningTest -> hub -> server -> page/

The watcher hears the test and is the only one that knows ROS; the hub is where its thread and those of the
server meet; the page draws what it gets and computes nothing about the test.
"""
