"""The graph of a hybrid test, recorded and analysed as by ``rthm run``; ends by itself after `duration`.

A node that ends before, the recorder among them, ends the launch with status 1; the analysis may go.

ros2 launch rthm_bringup hybrid_test.launch.py spec:=my_test.yaml duration:=20.0 out:=out/my_test
"""

from importlib.resources import files

from launch.actions import DeclareLaunchArgument, EmitEvent, LogInfo, RegisterEventHandler, TimerAction
from launch.conditions import IfCondition
from launch.events import Shutdown
from launch.events.process import ProcessExited
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import LifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchContext, LaunchDescription
from rthm_core.topics import NAMESPACE

AFTERWARDS = 2.5  # s: up to one until the begin, the rest for the last messages
PROGRAMS = {
    "recorder": ("rthm_bringup", "recorder"),
    "analysis": ("rthm_analysis", "analysis"),
    "numerical": ("rthm_numerical", "numerical"),
    "actuator": ("rthm_actuator", "actuator"),
    "plant": ("rthm_plant_sim", "plant_sim"),
}
"""Package and program of each node; those that watch come first."""

OBSERVERS = ("analysis",)
"""Nodes that may end before the test is over."""

ARGUMENTS = {
    "spec": (str(files("rthm_core.spec") / "shipped" / "paper.yaml"), "parameter file of the test"),
    "duration": ("20.0", "length of the test in s; 0: until Ctrl-C"),
    "out": ("out/launch", "folder of the recording, which must be new"),
    "namespace": (NAMESPACE, "namespace of the nodes"),
}


def generate_launch_description() -> LaunchDescription:
    """Describe the graph; every node configures and activates itself as soon as its peers are there."""
    arguments = [
        DeclareLaunchArgument(name, default_value=value, description=words)
        for name, (value, words) in ARGUMENTS.items()
    ]
    nodes = {name: _node(name) for name in PROGRAMS}
    begun = OnStateTransition(
        target_lifecycle_node=nodes["plant"], goal_state="active", entities=[_end_of_test()]
    )
    return LaunchDescription([*arguments, RegisterEventHandler(begun), *nodes.values()])


def _node(name: str) -> LifecycleNode:
    package, program = PROGRAMS[name]
    spec, duration = LaunchConfiguration("spec"), LaunchConfiguration("duration")
    told = {"autostart": True, "duration": ParameterValue(duration, value_type=float)}
    if name == "recorder":
        told |= {"bag": PathJoinSubstitution([LaunchConfiguration("out"), "bag"]), "spec_file": spec}
    settings = PathJoinSubstitution([FindPackageShare("rthm_bringup"), "config", "nodes.yaml"])
    return LifecycleNode(
        package=package,
        executable=program,
        name=name,
        namespace=LaunchConfiguration("namespace"),
        parameters=[settings, spec, told],
        output="screen",
        on_exit=None if name in OBSERVERS else _ended,
    )


def _ended(event: ProcessExited, context: LaunchContext) -> None:
    """Raise, which shuts everything down with status 1, when a node ends before the test is over."""
    if not context.is_shutdown:
        raise RuntimeError(f"{event.process_name} ended with status {event.returncode} before the test did")


def _end_of_test() -> TimerAction:
    duration = LaunchConfiguration("duration")
    return TimerAction(
        period=PythonExpression([duration, f" + {AFTERWARDS}"]),
        actions=[LogInfo(msg="the test is over"), EmitEvent(event=Shutdown(reason="the test is over"))],
        condition=IfCondition(PythonExpression([duration, " > 0.0"])),
    )
