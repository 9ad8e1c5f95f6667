"""Stands for a driver of real hardware: publishes plant/state every 1.2 ms, with nothing but rclpy.

The "hardware" is a mass that follows the command like a filter of first order. Like any driver, it runs with
real-time priority where the system grants it.

usage: driver.py SECONDS
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

with contextlib.suppress(PermissionError):
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
node = rclpy.create_node("driver", namespace="/rthm")
publisher = node.create_publisher(JointState, "plant/state", QoSProfile(depth=1000))
command = [0.5]
node.create_subscription(
    JointState, "actuator/command", lambda message: command.__setitem__(0, message.position[0]), 100
)
listener = threading.Thread(target=rclpy.spin, args=(node,))
listener.start()

message = JointState(name=["x1", "a1"], effort=[0.0, 0.0])
x, due = 0.5, time.time_ns()
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
    publisher.publish(message)
    due += PERIOD
rclpy.try_shutdown()
listener.join()
