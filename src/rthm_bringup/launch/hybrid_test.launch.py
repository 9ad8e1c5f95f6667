"""The graph of a hybrid test as ``rthm run`` starts it: nodes, recorder, analysis; ends by itself after `duration`.

ros2 launch rthm_bringup hybrid_test.launch.py spec:=my_test.yaml duration:=20.0 out:=out/my_test
"""

from launch.actions import DeclareLaunchArgument, EmitEvent, LogInfo, RegisterEventHandler, TimerAction
from launch.conditions import IfCondition
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import LifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchDescription

AFTERWARDS = 2.5  # s: up to one second until the begin, and time for the last messages
PROGRAMS = {
    "plant": ("rthm_plant_sim", "plant_sim"),
    "numerical": ("rthm_numerical", "numerical"),
    "actuator": ("rthm_actuator", "actuator"),
    "analysis": ("rthm_analysis", "analysis"),
    "recorder": ("rthm_bringup", "recorder"),
}


def generate_launch_description() -> LaunchDescription:
    """Describe the graph; every node configures and activates itself as soon as its peers are there."""
    spec, duration, out = (LaunchConfiguration(name) for name in ("spec", "duration", "out"))
    bag = PathJoinSubstitution([out, "bag"])
    common = {"autostart": True, "duration": ParameterValue(duration, value_type=float)}
    own = {"recorder": {"bag": bag, "spec_file": spec}, "analysis": {"bag": bag}}
    nodes = {
        name: LifecycleNode(
            package=package,
            executable=executable,
            name=name,
            namespace=LaunchConfiguration("namespace"),
            parameters=[spec, common | own.get(name, {})],
            output="screen",
        )
        for name, (package, executable) in PROGRAMS.items()
    }
    paper = PathJoinSubstitution([FindPackageShare("rthm_bringup"), "config", "paper.yaml"])
    over = TimerAction(
        period=PythonExpression([duration, " + ", str(AFTERWARDS)]),
        actions=[LogInfo(msg=["recorded in ", bag]), EmitEvent(event=Shutdown(reason="the test is over"))],
        condition=IfCondition(PythonExpression([duration, " > 0.0"])),
    )
    begun = OnStateTransition(target_lifecycle_node=nodes["plant"], goal_state="active", entities=[over])
    return LaunchDescription(
        [
            DeclareLaunchArgument("spec", default_value=paper, description="parameter file of the test"),
            DeclareLaunchArgument("duration", default_value="20.0", description="length of the test in s; 0: no end"),
            DeclareLaunchArgument("out", default_value="out/launch", description="folder of the recording"),
            DeclareLaunchArgument("namespace", default_value="/rthm", description="where the nodes live"),
            RegisterEventHandler(begun),
            *nodes.values(),
        ]
    )
