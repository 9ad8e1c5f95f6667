"""Stands for a driver of real hardware: publishes plant/state every 1.2 ms, with nothing but rclpy.

The "hardware" is a mass that follows the command like a filter of first order. Like any driver, it runs with
real-time priority where the system grants it, executes no old command, and moves no faster than it may. On
request it stands elsewhere than at 0.5 m, and has a fault some time after its first command, for some time.
Where DRIVER_LOG names a file, it leaves there how its motor was moved, and when the fault began.

usage: driver.py SECONDS [METRES [FAULT AFTER [LASTING]]]
"""

import contextlib
import json
import os
import pathlib
import signal
import sys
import threading
import time

import rclpy
import rclpy.signals
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

PERIOD = 1_200_000  # ns
RATE, COMMAND_AGE, LONGEST = 5.0, 0.5, 0.004  # m/s, s, s
FAULTS = {
    "nan": lambda message: message.effort.__setitem__(1, float("nan")),
    "inf": lambda message: message.position.__setitem__(0, float("inf")),
    "huge": lambda message: message.position.__setitem__(0, 1e9),
    "step": lambda message: message.position.__setitem__(0, message.position[0] + 0.3),
    "frozen": lambda message: message.position.__setitem__(0, frozen[0]),
    "cut": lambda message: message.effort.__setitem__(1, 0.0),
    "names": lambda message: setattr(message, "name", ["y1", "a1"]),
    "sizes": lambda message: setattr(message, "position", message.position[:1]),
    "twice": lambda message: publisher.publish(message),
    "old": lambda message: setattr(message.header.stamp, "sec", message.header.stamp.sec - 1),
    "ahead": lambda message: setattr(message.header.stamp, "sec", message.header.stamp.sec + 86_400),
    "silent": None,
}
metres = float(sys.argv[2]) if sys.argv[2:] else 0.5
fault, after, lasting = [*sys.argv[3:], *("", "inf", "inf")[len(sys.argv[3:]) :]]

with contextlib.suppress(PermissionError):
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
node = rclpy.create_node("driver", namespace="/rthm")
publisher = node.create_publisher(JointState, "plant/state", QoSProfile(depth=1000))
command, first, frozen, struck = [metres], [], [], []
moves, told, newest = [(time.time(), metres)], {"refused": 0, "held back": 0}, [0.0]


def obey(message):
    now, stamp = time.time(), message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
    first.extend([now] * (not first))
    if now - stamp > COMMAND_AGE or stamp <= newest[0] or not abs(message.position[0]) <= 1.0:
        told["refused"] += 1
        return
    newest[0] = stamp
    step = RATE * min(now - moves[-1][0], LONGEST)
    goes = min(max(message.position[0], command[0] - step), command[0] + step)
    told["held back"] += goes != message.position[0]
    command[0] = goes
    moves.append((now, goes))


node.create_subscription(JointState, "actuator/command", obey, 100)
listener = threading.Thread(target=rclpy.spin, args=(node,))
listener.start()

message = JointState(effort=[0.0, 0.0])
x, due = metres, time.time_ns()
end = due + int(float(sys.argv[1]) * 1e9)
asked = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: asked.set())
while due < end and not asked.is_set():
    time.sleep(max(0.0, (due - time.time_ns()) / 1e9))
    v = (command[0] - x) / 0.05
    x += v * PERIOD * 1e-9
    message.name = ["x1", "a1"]
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(due, 10**9)
    message.position, message.velocity = [x, command[0]], [v, 0.0]
    message.effort = [float("nan"), 40.0 * (command[0] - x)]
    if fault and first and 0.0 < time.time() - first[0] - float(after) < float(lasting):
        frozen.extend([x] * (not frozen))
        struck.extend([time.time()] * (not struck))
        if FAULTS[fault] is not None:
            FAULTS[fault](message)
            publisher.publish(message)
    else:
        publisher.publish(message)
    due += PERIOD
rclpy.try_shutdown()
listener.join()
if os.environ.get("DRIVER_LOG"):
    log = {"moves": moves, "struck": struck[0] if struck else None} | told
    pathlib.Path(os.environ["DRIVER_LOG"]).write_text(json.dumps(log))
