"""Names of a rig under ros2_control beside those of a spec."""

from __future__ import annotations

import pytest

from rthm_core.errors import InputError
from rthm_core.ros.messages import JointStateReader, JointStateWriter
from rthm_core.spec import shipped_spec
from rthm_plant_sim.ros2_control.joints import Joints

SPEC, THREE = shipped_spec(), shipped_spec("three_mass")


def test_a_joint_state_is_read_by_name_in_any_order() -> None:
    joints = Joints(SPEC, "x1=table, a1=piston")
    assert joints.names == ("table", "piston")
    names = ("gripper", "piston", "table")
    data = JointStateWriter(names).bytes(5, [9.0, 0.3, 0.1], [9.0, 3.0, 1.0], [9.0, 40.0, 7.0])
    reading = joints.reading(JointStateReader(joints.names).sample(data))
    assert (reading.position, reading.velocity, reading.motor) == ([0.1], [1.0], [0.3])
    assert (reading.force, reading.motor_velocity, reading.load, reading.stamp) == ([40.0], [3.0], None, 5)


def test_a_joint_that_is_missing_is_told() -> None:
    data = JointStateWriter(("table",)).bytes(5, [0.1], [0.1], [0.1])
    with pytest.raises(ValueError, match=r"names table, but not a1"):
        JointStateReader(Joints(SPEC, "x1=table").names).sample(data)


def test_commands_have_the_order_of_the_controller() -> None:
    dofs, actuators = THREE.loop().plant.dofs, THREE.loop().actuator.names
    assert dofs
    named = ",".join(f"{name}=motor_{k}" for k, name in enumerate(actuators))
    order = [f"motor_{k}" for k in reversed(range(len(actuators)))]
    joints = Joints(THREE, named, order)
    values = [0.1 * k for k in range(len(actuators))]
    assert joints.ordered(values) == values[::-1]
    assert Joints(THREE, named).ordered(values) == values


@pytest.mark.parametrize(
    ("named", "order", "words"),
    [
        ("x3=table", (), "'x3=table' names no joint, but must be NAME=JOINT with a name of the spec"),
        ("x1", (), "'x1' names no joint"),
        ("x1=a1", (), "The joint a1 stands for two names"),
        ("a1=piston", ("a1",), "The controller commands a1, but the motors of the test are piston"),
        ("", ("a1", "gripper"), "The controller commands a1, gripper"),
    ],
)
def test_names_that_do_not_fit_are_refused_in_one_sentence(
    named: str, order: tuple[str, ...], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        Joints(SPEC, named, order)
