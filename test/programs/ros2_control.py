"""Stands for a controller manager of ros2_control, with nothing but rclpy.

A joint state broadcaster publishes its joints on /joint_states, in an order of its own; a forward command
controller of the joint "piston" takes commands on /forward_position_controller/commands. The joint "table"
follows the piston like a filter of first order.

usage: ros2_control.py METRES
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
from std_msgs.msg import Float64MultiArray

PERIOD = 1_200_000  # ns
with contextlib.suppress(PermissionError):
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
node = rclpy.create_node("controller_manager")
publisher = node.create_publisher(JointState, "/joint_states", QoSProfile(depth=1000))
piston = [float(sys.argv[1])]


def obey(message):
    assert len(message.data) == 1
    piston[0] = message.data[0]


node.create_subscription(Float64MultiArray, "/forward_position_controller/commands", obey, 10)
listener = threading.Thread(target=rclpy.spin, args=(node,))
listener.start()
asked = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: asked.set())

message = JointState(name=["gripper", "piston", "table"])
table, due = piston[0], time.time_ns()
while not asked.is_set():
    time.sleep(max(0.0, (due - time.time_ns()) / 1e9))
    v = (piston[0] - table) / 0.05
    table += v * PERIOD * 1e-9
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(due, 10**9)
    message.position, message.velocity = [0.7, piston[0], table], [0.0, 0.0, v]
    message.effort = [0.0, 40.0 * (piston[0] - table), 0.0]
    publisher.publish(message)
    due += PERIOD
rclpy.try_shutdown()
listener.join()
