"""Publishes a topic of the loop that is somebody else's: plain rclpy, nothing of the project.

usage: rival.py TOPIC SECONDS [NAMESPACE]

Says `heard from NS` on standard error when somebody is connected to what it publishes, and `heard N` of
plant/state at its end.
"""

import sys
import time

import rclpy
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

topic, seconds, *rest = sys.argv[1:]
rclpy.init()
node = rclpy.create_node("rival", namespace=rest[0] if rest else "/rthm")
heard = [0]
node.create_subscription(
    JointState, "plant/state", lambda _: heard.__setitem__(0, heard[0] + 1), QoSProfile(depth=1000)
)
publisher = node.create_publisher(JointState, topic, QoSProfile(depth=100))
message = JointState(name=["x1", "x2", "a1"])
message.position = message.velocity = message.effort = [9.0, 9.0, 9.0]
end = time.time() + float(seconds)
connected = False
while time.time() < end:
    first = not connected and publisher.get_subscription_count() > 0
    now = time.time_ns()
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(now, 10**9)
    publisher.publish(message)
    if first:
        connected = True
        print(f"heard from {now}", file=sys.stderr, flush=True)
    again = time.monotonic() + 0.005
    while (left := again - time.monotonic()) > 0.0:
        rclpy.spin_once(node, timeout_sec=left)
print(f"heard {heard[0]}", flush=True)
rclpy.shutdown()
