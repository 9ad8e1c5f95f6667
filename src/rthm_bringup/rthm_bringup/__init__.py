"""The command line rthm, the run of a hybrid test, launch files and configuration."""
