"""The recorder as a process: nothing lost at 1.5 x the rates of the demo, little lost when it is killed."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.reader import make_reader

from rthm_analysis.recording import read_recording
from rthm_bringup.run import roles, shared_memory
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.environment import Network
from rthm_bringup.run.processes import Process, Processes
from rthm_core.spec import read_spec, shipped_spec, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]

RATES = {  # Hz, 1.5 times those of the paper's test
    "plant/state": 1250.0,
    "numerical/state": 125.0,
    "numerical/force_reference": 125.0,
    "actuator/command": 375.0,
    "links/tau1": 375.0,
    "links/tau2": 125.0,
    "links/tau3": 375.0,
    "links/tau4": 375.0,
}
FLOOD = Path(__file__).parent / "programs" / "flood.py"


@pytest.fixture
def recorder(tmp_path: Path) -> Process:
    spec = tmp_path / "spec.yaml"
    spec.write_text(write_spec(shipped_spec()))
    told = roles.parameters("recorder", spec, tmp_path / "bag", False, None)
    return Process("recorder", roles.command("recorder", spec, told), tmp_path / "recorder.log")


def flooding(
    environment: dict[str, str], seconds: float, rates: dict[str, float] = RATES
) -> subprocess.Popen[str]:
    words = [sys.executable, str(FLOOD), str(seconds), *(f"{topic}={rate}" for topic, rate in rates.items())]
    return subprocess.Popen(words, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def begin_recording(conductor: Conductor, flood: subprocess.Popen[str]) -> None:
    assert flood.stdin
    assert flood.stdout
    conductor.wait_for(["recorder"], 20.0)
    conductor.step("configure", ["recorder"])
    conductor.wait_ready(["recorder"], 20.0)
    assert flood.stdout.readline() == "matched\n"
    conductor.step("activate", ["recorder"])
    flood.stdin.write("begin\n")
    flood.stdin.flush()


def test_nothing_is_lost_at_one_and_a_half_times_the_rates_of_the_demo(
    recorder: Process, environment: dict[str, str], network: Network, tmp_path: Path
) -> None:
    with Processes() as processes, Conductor(lambda: None, network.domain) as conductor:
        processes.start(recorder, environment)
        with flooding(environment, 3.0) as flood:
            begin_recording(conductor, flood)
            begin, *pairs = flood.stdout.readline().split()
            time.sleep(0.3)
            conductor.step("deactivate", ["recorder"])
            flood.communicate("end\n")
    published = {f"/rthm/{topic}": int(count) for topic, count in (pair.split("=") for pair in pairs)}
    stamps: dict[str, list[int]] = defaultdict(list)
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages(log_time_order=False):
            assert message.log_time >= message.publish_time > 0
            stamps[channel.topic].append(stamp_of(message.data))
    for topic, rate in RATES.items():
        expected = [int(begin) + round(k * 1e9 / rate) for k in range(published[f"/rthm/{topic}"])]
        assert stamps[f"/rthm/{topic}"] == expected, topic
    assert "lost: '0'" in (tmp_path / "bag" / "metadata.yaml").read_text()


def test_accelerations_that_a_driver_publishes_are_recorded(
    recorder: Process, environment: dict[str, str], network: Network, tmp_path: Path
) -> None:
    rates = dict.fromkeys([*RATES, "plant/acceleration"], 80.0)
    with Processes() as processes, Conductor(lambda: None, network.domain) as conductor:
        processes.start(recorder, environment)
        with flooding(environment, 1.0, rates) as flood:
            begin_recording(conductor, flood)
            _, *pairs = flood.stdout.readline().split()
            time.sleep(0.3)
            conductor.step("deactivate", ["recorder"])
            flood.communicate("end\n")
    recording = read_recording(tmp_path / "bag")
    counts = dict(pair.split("=") for pair in pairs)
    assert len(recording.tables["plant/acceleration"]) == int(counts["plant/acceleration"]) > 50


def test_the_spec_is_the_first_message(
    recorder: Process, environment: dict[str, str], network: Network, tmp_path: Path
) -> None:
    with Processes() as processes, Conductor(lambda: None, network.domain) as conductor:
        processes.start(recorder, environment)
        conductor.wait_for(["recorder"], 20.0)
        conductor.step("configure", ["recorder"])
        conductor.step("activate", ["recorder"])
        conductor.step("deactivate", ["recorder"])
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as stream:
        _, channel, message = next(iter(make_reader(stream).iter_messages(log_time_order=False)))
    assert channel.topic == "/rthm/spec"
    assert read_spec(message.data[8:].rstrip(b"\0").decode()) == shipped_spec()


def test_a_killed_recorder_loses_at_most_the_last_second(
    recorder: Process,
    environment: dict[str, str],
    network: Network,
    tmp_path: Path,
    host_stalls: Callable[[float], float],
) -> None:
    memory = shared_memory.files()
    with Processes() as processes, Conductor(lambda: None, network.domain) as conductor:
        processes.start(recorder, environment)
        with flooding(environment, 3.0) as flood:
            begin_recording(conductor, flood)
            time.sleep(2.0)
            recorder.send(signal.SIGKILL)
            killed, allowed = time.time_ns(), int(1e9 * (1.0 + host_stalls(5.0)))
            begin, *_ = flood.communicate("end\n")[0].split()
    shared_memory.clean_up(memory)
    recording = read_recording(tmp_path / "bag")
    assert recording.spec == shipped_spec()
    stamps = [stamp_of(data) for data in raw(tmp_path / "bag" / "bag_0.mcap", "/rthm/plant/state")]
    assert stamps[0] == int(begin)
    assert stamps[-1] > killed - allowed
    assert stamps == [int(begin) + round(k * 1e9 / RATES["plant/state"]) for k in range(len(stamps))]


def raw(path: Path, topic: str) -> list[bytes]:
    """Messages of a topic in an MCAP file without an index."""
    from mcap.exceptions import McapError
    from mcap.records import Channel, Message
    from mcap.stream_reader import StreamReader

    channels, found = {}, []
    with path.open("rb") as stream:
        try:
            for record in StreamReader(stream).records:
                if isinstance(record, Channel):
                    channels[record.id] = record.topic
                elif isinstance(record, Message) and channels[record.channel_id] == topic:
                    found.append(record.data)
        except McapError:
            pass
    return found


def stamp_of(data: bytes) -> int:
    return int.from_bytes(data[4:8], "little") * 10**9 + int.from_bytes(data[8:12], "little")
