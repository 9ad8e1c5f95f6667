"""Takes a share of every core away, as a hypervisor does that gives it to others; needs real-time priority.

usage: thief.py SHARE STALL SECONDS & pytest -m graph

Stalls are of random length, STALL s in the mean and five times that at most.
"""

import os
import random
import sys
import time

LONGEST = 5.0  # in means

share, stall, seconds = map(float, sys.argv[1:])
core, *others = sorted(os.sched_getaffinity(0))
for other in others:
    if os.fork() == 0:
        core = other
        break
os.sched_setaffinity(0, {core})
os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(95))


def length() -> float:
    return min(random.expovariate(1.0 / stall), LONGEST * stall)


end = time.monotonic() + seconds
while time.monotonic() < end:
    over = time.monotonic() + length()
    while time.monotonic() < over:
        pass
    time.sleep(length() * (1.0 - share) / share)
