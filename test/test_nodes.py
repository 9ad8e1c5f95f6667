"""The nodes of the loop as any ROS client sees them: lifecycle, parameters, topics, faults."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState, TimeReference

from rthm_bringup.run.beginning import begin_together
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.environment import Network
from rthm_bringup.run.question import ACTIVE, CHANGES, INACTIVE
from rthm_bringup.run.stopped import StoppedError
from rthm_core.clock import NS
from rthm_core.schedule import Schedule, newest
from rthm_core.spec import parameters, shipped_spec, spec_from_parameters, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]

MODULES = {"plant": "rthm_plant_sim", "numerical": "rthm_numerical", "actuator": "rthm_actuator"}
LOOP = tuple(MODULES)
LIMITS = {"limits.command": 1.0, "limits.rate": 20.0, "limits.stale": 2.0, "limits.ramp": 0.4}
"""A sample that a busy machine holds up is not called stale."""
RECEIVERS = {"tau1": "actuator", "tau2": "numerical", "tau3": "actuator", "tau4": "plant"}
USES = {"tau1": 600, "tau2": 200, "tau3": 200, "tau4": 598}  # in 2.4 s; the first ticks use the initial state
PAPER = {entry.name: entry.value for entry in parameters(shipped_spec())}


def ns(stamp: Any) -> int:
    return stamp.sec * NS + stamp.nanosec


class Graph:
    """Nodes as processes, and a client that is not a part of the project's nodes."""

    def __init__(self, environment: dict[str, str], domain: int, folder: Path) -> None:
        self.environment, self.folder = environment, folder
        self.processes: dict[str, subprocess.Popen[str]] = {}
        self.conductor = Conductor(lambda: None, domain)
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self.client = rclpy.create_node("client", namespace="/rthm", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.client)
        self.diagnostics: list[Any] = self.listen(DiagnosticArray, "/diagnostics")

    def start(self, names: tuple[str, ...] = LOOP, spec: dict[str, Any] | None = None, **own: Any) -> None:
        file = self.folder / "spec.yaml"
        file.write_text(write_spec(spec_from_parameters(PAPER | (spec or {}))))
        told = [word for key, value in own.items() for word in ("-p", f"{key}:={value}")]
        for name in names:
            command = [sys.executable, "-m", f"{MODULES[name]}.node", "--ros-args"]
            self.processes[name] = subprocess.Popen(
                [*command, "--params-file", str(file), *told],
                env=self.environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
        self.conductor.wait_for(names, 60.0)

    def configure(self, names: tuple[str, ...] = LOOP) -> None:
        self.conductor.step("configure", names, 240.0)

    def activate(self, duration: float, names: tuple[str, ...] = LOOP) -> int:
        return begin_together(self.conductor, names, duration)

    def listen(self, kind: type, topic: str) -> list[Any]:
        heard: list[Any] = []
        self.client.create_subscription(kind, topic, heard.append, QoSProfile(depth=4000))
        return heard

    def wait(self, seconds: float, until: Callable[[], object] = lambda: False) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until():
            self._executor.spin_once(timeout_sec=0.05)

    def status(self, part: str) -> Any:
        """Newest status of a part of a node, as ``/rthm/plant: loop``."""
        statuses = [status for message in self.diagnostics for status in message.status]
        return next((status for status in reversed(statuses) if status.name == part), None)

    def facts(self, name: str) -> dict[str, str]:
        """What a node told last of its loop."""
        status = self.status(f"/rthm/{name}: loop")
        return {pair.key: pair.value for pair in status.values} if status else {}

    def has_told(self, name: str, clock: str, ticks: int) -> bool:
        """Whether a node has told that its clock came so far."""
        return self.facts(name).get(f"{clock} ticks") == str(ticks)

    def ended(self, name: str) -> tuple[int, str]:
        process = self.processes.pop(name)
        out, _ = process.communicate(timeout=20)
        return process.returncode, out

    def close(self) -> None:
        for process in self.processes.values():
            process.terminate()
        for process in self.processes.values():
            print(process.communicate(timeout=20)[0])  # pytest shows it when the test has failed
        self._executor.shutdown()
        self.client.destroy_node()
        rclpy.try_shutdown(context=self._context)
        self.conductor.__exit__(None, None, None)


@pytest.fixture
def graph(environment: dict[str, str], network: Network, tmp_path: Path) -> Iterator[Graph]:
    graph = Graph(environment, network.domain, tmp_path)
    yield graph
    graph.close()


def scheduled(schedule: Schedule, link: str, period: int, at: int) -> int:
    """Stamp of the sample that the schedule has in use at the tick to which an instant belongs, ns."""
    tick = np.array([at // period * period])
    return int(newest(schedule.links[link], schedule.td1, tick)[0]) * schedule.td1


def test_every_link_keeps_its_delay_and_the_samples_of_the_schedule(graph: Graph) -> None:
    graph.start()
    graph.configure()
    graph.conductor.wait_ready(LOOP, 30.0)
    uses = {name: graph.listen(TimeReference, f"links/{name}") for name in ("tau1", "tau2", "tau3", "tau4")}
    states, commands = graph.listen(JointState, "plant/state"), graph.listen(JointState, "actuator/command")
    graph.wait(1.0)
    begin = graph.activate(2.4)
    graph.wait(20.0, lambda: len(states) == 2001 and len(uses["tau4"]) >= 598)
    ticks = {"plant": ("Td1", 2001), "numerical": ("Td2", 201), "actuator": ("Td3", 601)}
    graph.wait(20.0, lambda: all(graph.has_told(name, *last) for name, last in ticks.items()))
    assert [ns(state.header.stamp) - begin for state in states] == [k * 1_200_000 for k in range(2001)]
    commanded = [ns(command.header.stamp) - begin for command in commands]
    at_ticks = [at for at in commanded if at % 4_000_000 == 0]  # a late reference is used between two
    left_out = 601 - len(at_ticks)  # where the host was busy
    assert left_out <= int(graph.facts("actuator")["Td3 missed deadlines"])
    assert sorted({*at_ticks} | {k * 4_000_000 for k in range(601)}) == [k * 4_000_000 for k in range(601)]
    schedule = Schedule(shipped_spec())
    for name, heard in uses.items():
        link, late = schedule.links[name], int(graph.facts(RECEIVERS[name])[f"{name} late"])
        assert all(use.source == name for use in heard)
        at = [ns(use.header.stamp) - begin for use in heard]
        sample = [ns(use.time_ref) - begin for use in heard]
        assert all(use - stamp >= link.delay_ns for use, stamp in zip(at, sample, strict=True))
        assert sample == sorted(sample)
        # A sample that came in time is used as the schedule says; where the host was busy, some were late.
        assert USES[name] - late - left_out <= len(heard) <= max(USES[name], len(commands))
        if name in ("tau1", "tau2"):
            period = schedule.td3 if name == "tau1" else schedule.td2
            expected = [scheduled(schedule, name, period, use) for use in at]
            assert sum(one != other for one, other in zip(sample, expected, strict=True)) <= late


def test_a_command_names_what_the_controller_used(graph: Graph) -> None:
    graph.start(("actuator",))
    graph.configure(("actuator",))
    commands = graph.listen(JointState, "actuator/command")
    graph.wait(1.0)
    begin = graph.activate(0.1, ("actuator",))
    graph.wait(20.0, lambda: len(commands) and ns(commands[-1].header.stamp) == begin + 100_000_000)
    first = commands[0]
    assert first.name == ["a1"]
    assert first.effort[0] == pytest.approx(-3.0)
    assert first.position[0] == pytest.approx(0.5 - 3.0 / 40.0)


def test_samples_of_any_client_drive_the_controller_from_the_first_one_on(graph: Graph) -> None:
    graph.start(("actuator",), duration=0.4)
    graph.configure(("actuator",))
    commands, uses = graph.listen(JointState, "actuator/command"), graph.listen(TimeReference, "links/tau1")
    feed = graph.client.create_publisher(JointState, "plant/state", 100)
    graph.wait(1.0)
    graph.conductor.step("activate", ("actuator",))
    graph.wait(0.5)
    assert commands == []
    begin = time.time_ns()
    for k in range(300):
        state = JointState(name=["a1", "x1"], position=[0.0, 0.25], velocity=[0.0, 0.0], effort=[0.0, 0.0])
        state.header.stamp.sec, state.header.stamp.nanosec = divmod(begin + k * 1_200_000, NS)
        feed.publish(state)
        graph.wait(0.001)
    graph.wait(20.0, lambda: commands and ns(commands[-1].header.stamp) == begin + 400_000_000)
    assert ns(commands[0].header.stamp) == begin
    assert commands[0].position[0] == pytest.approx(0.5 - 3.0 / 40.0)
    assert commands[-1].position[0] == pytest.approx(0.25 - 3.0 / 40.0)
    assert all((ns(use.time_ref) - begin) % 1_200_000 == 0 for use in uses)


def test_the_death_of_the_numerical_node_brings_the_motors_back_to_rest(graph: Graph) -> None:
    graph.start(spec=LIMITS)
    graph.configure()
    graph.conductor.wait_ready(LOOP, 30.0)
    commands = graph.listen(JointState, "actuator/command")
    graph.wait(1.0)
    begin = graph.activate(0.0)
    graph.wait(20.0, lambda: commands and ns(commands[-1].header.stamp) > begin + NS)
    os.kill(graph.processes["numerical"].pid, signal.SIGKILL)
    monitor = "/rthm/actuator: safety monitor"
    graph.wait(20.0, lambda: (status := graph.status(monitor)) and status.level == b"\x02")
    assert "numerical/force_reference has had no fresh sample" in graph.status(monitor).message
    graph.wait(20.0, lambda: commands[-1].position[0] == commands[0].position[0])
    positions = np.array([command.position[0] for command in commands])
    assert positions[-1] == positions[0] == pytest.approx(0.425)
    assert np.abs(positions).max() <= 1.0
    assert np.abs(np.diff(positions)).max() <= 20.0 * 0.004 * (1 + 1e-9)  # also where a tick was left out
    graph.processes["actuator"].terminate()
    status, said = graph.ended("actuator")
    assert status == 0
    assert "stopped at" in said
    assert "Traceback" not in said


def test_deactivation_in_the_middle_brings_the_motors_back_to_rest_first(graph: Graph) -> None:
    graph.start(spec=LIMITS)
    graph.configure()
    graph.conductor.wait_ready(LOOP, 30.0)
    commands = graph.listen(JointState, "actuator/command")
    graph.wait(1.0)
    begin = graph.activate(0.0)
    graph.wait(20.0, lambda: commands and ns(commands[-1].header.stamp) > begin + NS)
    before = commands[-1].position[0]
    graph.conductor.step("deactivate", ("actuator",))
    graph.wait(20.0, lambda: commands[-1].position[0] == pytest.approx(0.425))
    assert before != pytest.approx(0.425, abs=1e-3)
    assert commands[-1].position[0] == pytest.approx(0.425)
    graph.conductor.step("deactivate", ("numerical", "plant"))
    graph.conductor.step("cleanup", LOOP)


def test_while_a_test_runs_a_node_answers_only_to_its_leader(graph: Graph) -> None:
    graph.start(priority=0)
    graph.configure()
    graph.activate(600.0)
    stranger = graph.client.create_client(ChangeState, "/rthm/actuator/change_state")
    stranger.wait_for_service(20.0)
    for step in ("deactivate", "cleanup"):
        asked = stranger.call_async(ChangeState.Request(transition=Transition(id=CHANGES[step].number)))
        graph.wait(20.0, asked.done)
        assert not asked.result().success
    locks = graph.client.create_client(SetParameters, "/rthm/actuator/set_parameters")
    locks.wait_for_service(20.0)
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="")
    asked = locks.call_async(SetParameters.Request(parameters=[Parameter(name="leader", value=value)]))
    graph.wait(20.0, asked.done)
    assert "only by the leader" in asked.result().results[0].reason
    assert graph.conductor.states(LOOP) == dict.fromkeys(LOOP, ACTIVE)
    graph.conductor.step("deactivate", LOOP)
    assert graph.conductor.states(LOOP) == dict.fromkeys(LOOP, INACTIVE)


def test_a_node_answers_nonsense_with_a_sentence_and_lives_on(graph: Graph) -> None:
    graph.start(("plant",))
    with pytest.raises(StoppedError, match="plant refused to activate"):
        graph.conductor.step("activate", ("plant",))
    graph.conductor.set({"plant": {"plant.dofs": ["head"], "timing.tau1": 1}})
    with pytest.raises(StoppedError, match="plant refused to configure"):
        graph.configure(("plant",))
    graph.conductor.set({"plant": {"plant.dofs": ["x1"]}})
    graph.configure(("plant",))
    with pytest.raises(StoppedError, match="only before the node is configured"):
        graph.conductor.set({"plant": {"timing.tau1": 0.5}})
    graph.conductor.set({"plant": {"start_time": 1}})
    with pytest.raises(StoppedError, match="plant refused to activate"):
        graph.conductor.step("activate", ("plant",))
    ready, why = graph.conductor.trigger("plant", "ready", 10.0)
    assert not ready
    assert why == "waits for the other side of actuator/command, plant/state"
    graph.processes["plant"].send_signal(signal.SIGINT)
    status, said = graph.ended("plant")
    assert status == 0
    assert "head" in said
    assert "start_time is 1" in said
    assert "Traceback" not in said


def test_nodes_that_start_by_themselves_find_each_other_and_agree_on_the_start(graph: Graph) -> None:
    states, forces = graph.listen(JointState, "plant/state"), graph.listen(JointState, "numerical/state")
    commands = graph.listen(JointState, "actuator/command")
    graph.start(autostart="true", duration=1.0)
    graph.wait(300.0, lambda: len(forces) >= 84 and len(states) >= 834)
    graph.wait(20.0, lambda: graph.has_told("plant", "Td1", 834))
    assert ns(states[0].header.stamp) == ns(forces[0].header.stamp)
    assert ns(states[0].header.stamp) % NS == 0
    assert len(states) == 834
    assert len(forces) == 84
    graph.wait(20.0, lambda: graph.facts("plant").get("tau4 received") == str(len(commands)))
    facts = graph.facts("plant")
    assert facts["Td1 ticks"] == "834"
    graph.wait(20.0, lambda: graph.has_told("actuator", "Td3", 251))
    left_out = int(graph.facts("actuator")["Td3 missed deadlines"])
    assert len(commands) >= 251 - left_out  # a reference that is late is used between two ticks
    assert facts["tau4 received"] == str(len(commands))
