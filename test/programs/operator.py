"""Stands for an operator beside a rig, with nothing but rclpy: when it is asked to end, it aborts the test.

usage: operator.py service | topic | heartbeat
"""

import signal
import sys
import threading
import time

import rclpy
import rclpy.signals
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

way = sys.argv[1]
asked = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: asked.set())
rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
node = rclpy.create_node("operator", namespace="/rthm")
abort, heartbeat = node.create_publisher(Bool, "abort", 10), node.create_publisher(Bool, "heartbeat", 10)
client = node.create_client(Trigger, "actuator/abort")
while not asked.is_set():
    if way == "heartbeat":
        heartbeat.publish(Bool(data=True))
    rclpy.spin_once(node, timeout_sec=0.05)
if way == "topic":
    abort.publish(Bool(data=True))
    time.sleep(0.5)
if way == "service":
    client.wait_for_service()
    answer = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, answer, timeout_sec=30)
    print(answer.result(), flush=True)
rclpy.try_shutdown()
