"""The command line ``rthm VERB ...``: each verb is one file in `verbs`."""

from rthm_bringup.cli.main import main

__all__ = ["main"]
