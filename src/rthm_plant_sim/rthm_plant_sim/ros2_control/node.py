"""Node ``driver`` beside a controller manager: a joint state becomes a ``plant/state`` with its own stamp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from rthm_core.ros.messages import JointStateReader
from rthm_core.ros.polling import Info, Listener
from rthm_core.ros.qos import samples
from rthm_core.spec import Spec
from rthm_plant_sim.driver.node import DriverNode
from rthm_plant_sim.ros2_control.joints import Joints


class BridgeNode(DriverNode):
    """Driver of a rig that is commanded by a controller of ros2_control.

    Parameters
    ----------
    spec, joints, dead_time
        As for a driver, and the names.
    states, commands
        Topics of the joint state broadcaster and of the command controller.
    """

    def __init__(
        self, spec: Spec, joints: Joints, states: str, commands: str, dead_time: float = 0.0
    ) -> None:
        super().__init__(_Controller(self, joints), spec, dead_time, polled=False)
        self._joints, self._read_state = joints, JointStateReader(joints.names).sample
        self.commands = self.create_publisher(Float64MultiArray, commands, QoSProfile(depth=1))
        self._listener = Listener(self, JointState, states, samples(), self._hear)

    def _hear(self, data: bytes, info: Info) -> None:
        if not self.ports.speaking:
            return
        try:
            state = self._read_state(data)
        except ValueError as error:
            self._teller.say(f"a message of {self._listener.subscription.topic_name} {error}")
            return
        self.publish(self._joints.reading(state))


class _Controller:
    """The command controller as a device; it is read by what it publishes."""

    def __init__(self, node: BridgeNode, joints: Joints) -> None:
        self._node, self._joints = node, joints

    def read(self) -> None:
        """Nothing is read when it is asked for."""

    def command(self, u: NDArray[np.float64]) -> None:
        """Command the motors in the order of the controller."""
        self._node.commands.publish(Float64MultiArray(data=self._joints.ordered(u.tolist())))
