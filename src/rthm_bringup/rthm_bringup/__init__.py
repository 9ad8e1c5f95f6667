"""The command line rthm, the run of a hybrid test, launch files and configuration."""

import os

# All matrices here are small: threads of the linear algebra would only disturb those of a running test.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
