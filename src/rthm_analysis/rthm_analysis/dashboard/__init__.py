"""A running test at a glance: from the messages of a test to what its page shows. No ROS, no page.

`RunningTest` takes messages as they come, and gives some times a second what is to be shown, in the types of
JSON.
"""

from rthm_analysis.dashboard.running import TOPICS, Facts, RunningTest
from rthm_analysis.dashboard.traces import Trace

__all__ = ["TOPICS", "Facts", "RunningTest", "Trace"]
