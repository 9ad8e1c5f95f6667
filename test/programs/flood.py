"""Publishes every topic of the loop at given rates for some seconds: plain rclpy, nothing of the project.

usage: flood.py SECONDS TOPIC=RATE ...
"""

import sys
import time

import rclpy
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState, TimeReference

seconds = float(sys.argv[1])
rates = {topic: float(rate) for topic, rate in (pair.split("=") for pair in sys.argv[2:])}

rclpy.init()
node = rclpy.create_node("flood", namespace="/rthm")
publishers, messages, due, counts = {}, {}, {}, dict.fromkeys(rates, 0)
for topic in rates:
    kind = TimeReference if topic.startswith("links/") else JointState
    publishers[topic] = node.create_publisher(kind, topic, QoSProfile(depth=100))
    messages[topic] = kind()
    if kind is JointState:
        messages[topic].name = ["x1", "a1"]
        messages[topic].position = messages[topic].velocity = messages[topic].effort = [0.0, 0.0]
while any(publisher.get_subscription_count() < 1 for publisher in publishers.values()):
    time.sleep(0.05)
print("matched", flush=True)
sys.stdin.readline()
begin = time.time_ns()
due = dict.fromkeys(rates, 0)
end = int(seconds * 1e9)
while (now := time.time_ns() - begin) < end:
    for topic, rate in rates.items():
        if due[topic] <= now:
            stamp = begin + due[topic]
            messages[topic].header.stamp.sec, messages[topic].header.stamp.nanosec = divmod(stamp, 10**9)
            publishers[topic].publish(messages[topic])
            counts[topic] += 1
            due[topic] = round(counts[topic] * 1e9 / rate)
    time.sleep(max(0.0, (min(due.values()) - (time.time_ns() - begin)) / 1e9))
print(begin, *(f"{topic}={count}" for topic, count in counts.items()), flush=True)
sys.stdin.readline()
rclpy.shutdown()
