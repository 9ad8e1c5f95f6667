"""What a process asks of the operating system, and gives back."""

from __future__ import annotations

import subprocess
import sys

import pytest

CODE = """
import os, threading
from rthm_core.ros import system
wait = threading.Event()
threading.Thread(target=wait.wait, daemon=True).start()
def policies():
    return {os.sched_getscheduler(int(thread)) for thread in os.listdir("/proc/self/task")}
granted = system.prepare(5, lock_memory=False).priority
print(granted, policies() == {os.SCHED_FIFO if granted else os.SCHED_OTHER})
system.as_usual()
print(policies() == {os.SCHED_OTHER})
"""


def test_priority_of_all_threads_is_taken_and_given_back() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    granted, taken, given_back = done.stdout.split()
    if granted == "0":
        pytest.skip("this system grants no real-time priority")
    assert (granted, taken, given_back) == ("5", "True", "True")
