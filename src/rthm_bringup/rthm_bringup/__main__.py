"""``python -m rthm_bringup VERB ...``."""

from rthm_bringup.cli.main import main

main()
