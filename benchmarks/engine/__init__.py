"""Speed and accuracy of the engine beside what one would take instead.

Libraries for linear algebra are given one thread, before anything loads them: idle threads of theirs spin for
some milliseconds, and this would count as CPU time of whatever is measured next.
"""

import os

THREADS = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}

os.environ.update(THREADS)
