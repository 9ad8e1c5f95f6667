"""Stands for a driver of real hardware: publishes plant/state every 1.2 ms, with nothing but rclpy.

The "hardware" is a mass that follows the command like a filter of first order. Like any driver, it runs with
real-time priority where the system grants it. On request it stands elsewhere than at 0.5 m, and has a fault
some time after its first command.

usage: driver.py SECONDS [METRES [FAULT AFTER]]
"""

import contextlib
import os
import signal
import sys
import threading
import time

import rclpy
import rclpy.signals
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

PERIOD = 1_200_000  # ns
FAULTS = {
    "none": lambda message: None,
    "nan": lambda message: message.effort.__setitem__(1, float("nan")),
    "step": lambda message: message.position.__setitem__(0, message.position[0] + 0.3),
    "frozen": lambda message: message.position.__setitem__(0, frozen[0]),
    "old": lambda message: setattr(message.header.stamp, "sec", message.header.stamp.sec - 1),
    "silent": None,
}
metres = float(sys.argv[2]) if sys.argv[2:] else 0.5
fault, after = (sys.argv[3], float(sys.argv[4])) if sys.argv[3:] else ("none", 0.0)

with contextlib.suppress(PermissionError):
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
node = rclpy.create_node("driver", namespace="/rthm")
publisher = node.create_publisher(JointState, "plant/state", QoSProfile(depth=1000))
command, first, frozen = [metres], [], []


def obey(message):
    first.extend([time.time()] * (not first))
    command[0] = message.position[0]


node.create_subscription(JointState, "actuator/command", obey, 100)
listener = threading.Thread(target=rclpy.spin, args=(node,))
listener.start()

message = JointState(name=["x1", "a1"], effort=[0.0, 0.0])
x, due = metres, time.time_ns()
end = due + int(float(sys.argv[1]) * 1e9)
asked = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: asked.set())
while due < end and not asked.is_set():
    time.sleep(max(0.0, (due - time.time_ns()) / 1e9))
    v = (command[0] - x) / 0.05
    x += v * PERIOD * 1e-9
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(due, 10**9)
    message.position, message.velocity = [x, command[0]], [v, 0.0]
    message.effort = [float("nan"), 40.0 * (command[0] - x)]
    spoil = FAULTS[fault] if first and time.time() > first[0] + after else FAULTS["none"]
    if spoil is not None:
        frozen.extend([x] * (spoil is not FAULTS["none"] and not frozen))
        spoil(message)
        publisher.publish(message)
    due += PERIOD
rclpy.try_shutdown()
listener.join()
