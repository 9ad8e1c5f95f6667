"""Reading bags of every kind."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.recording import hold, read_recording
from rthm_core.errors import InputError

from .conftest import (
    NAN,
    PERIOD,
    START,
    joint_state,
    mcap_file,
    plant_samples,
    rosbag2,
    text,
    time_reference,
)

COUNT = 200


def assert_holds_the_plant(path: Path, count: int = COUNT) -> None:
    plant = read_recording(path).plant
    t = np.arange(count) * PERIOD * 1e-9
    assert plant.names == ("x1", "a1")
    np.testing.assert_array_equal(plant.stamp_ns, START + np.arange(count) * PERIOD)
    np.testing.assert_array_equal(plant.columns("position", ["x1"])[:, 0], np.cos(t))
    np.testing.assert_array_equal(plant.columns("velocity", ["x1"])[:, 0], -np.sin(t))
    np.testing.assert_array_equal(plant.columns("effort", ["a1"])[:, 0], np.arange(count))
    assert np.isnan(plant.columns("effort", ["x1"])).all()


WRITTEN_BY_ROSBAG2 = [
    ("mcap", "none"),
    ("mcap", "storage"),
    ("sqlite3", "none"),
    ("sqlite3", "file"),
    ("sqlite3", "message"),
]


@pytest.mark.parametrize(("storage", "compression"), WRITTEN_BY_ROSBAG2)
def test_a_bag_of_rosbag2_equals_memory(tmp_path: Path, storage: str, compression: str) -> None:
    assert_holds_the_plant(rosbag2(tmp_path / "bag", plant_samples(), storage, compression))


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_an_mcap_file_by_itself_is_a_recording(tmp_path: Path, compression: str) -> None:
    assert_holds_the_plant(mcap_file(tmp_path / "one.mcap", plant_samples(), compression=compression))


def test_a_recording_in_several_files_is_read_as_one(tmp_path: Path) -> None:
    messages = plant_samples()
    mcap_file(tmp_path / "bag_10.mcap", messages[150:])
    mcap_file(tmp_path / "bag_9.mcap", messages[:150])
    assert_holds_the_plant(tmp_path)


def test_a_bag_without_metadata_is_read_and_said(plant_bag) -> None:
    bag = plant_bag("sqlite3")
    (bag / "metadata.yaml").unlink()
    assert_holds_the_plant(bag)
    assert any("metadata.yaml" in note for note in read_recording(bag).notes)


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
@pytest.mark.parametrize("chunk_size", [4096, 10**6])
def test_a_bag_cut_off_by_a_crash_gives_all_but_its_end(
    tmp_path: Path, compression: str, chunk_size: int
) -> None:
    file = mcap_file(tmp_path / "cut.mcap", plant_samples(2000), chunk_size, compression)
    whole = file.read_bytes()
    file.write_bytes(whole[: int(0.6 * len(whole))])
    recording = read_recording(file)
    assert any("cut off" in note for note in recording.notes)
    assert_holds_the_plant(file, len(recording.plant))
    assert len(recording.plant) > 900


def test_a_damaged_chunk_is_left_out_and_said(tmp_path: Path) -> None:
    file = mcap_file(tmp_path / "damaged.mcap", plant_samples(), compression="NONE")
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 0xFF
    file.write_bytes(content)
    recording = read_recording(file)
    assert 100 < len(recording.plant) < COUNT
    assert any("damaged" in note for note in recording.notes)


@pytest.mark.parametrize("topic", ["/plant/state", "/lab/rig_3/plant/state", "plant/state"])
def test_topics_are_known_by_their_relative_name(tmp_path: Path, topic: str) -> None:
    bag = rosbag2(tmp_path / "bag", plant_samples(topic=topic))
    assert_holds_the_plant(bag)


def test_of_two_tests_in_one_bag_the_named_one_is_taken(tmp_path: Path) -> None:
    messages = plant_samples(topic="/a/plant/state") + plant_samples(50, topic="/b/plant/state")
    bag = mcap_file(tmp_path / "two.mcap", messages)
    assert len(read_recording(bag).plant) == COUNT
    assert "2 tests" in " ".join(read_recording(bag).notes)
    assert len(read_recording(bag, namespace="/b").plant) == 50
    with pytest.raises(InputError, match="/c"):
        read_recording(bag, namespace="c")


def test_fields_that_a_driver_leaves_empty_are_not_known(tmp_path: Path) -> None:
    messages = [joint_state("/plant/state", START + k * PERIOD, ("x1",), (float(k),)) for k in range(5)]
    plant = read_recording(mcap_file(tmp_path / "x.mcap", messages)).plant
    assert np.isnan(plant.velocity).all()
    assert np.isnan(plant.effort).all()
    np.testing.assert_array_equal(plant.position[:, 0], np.arange(5.0))


def test_big_endian_messages_of_another_shape_and_order_of_names_fit_into_one_table(tmp_path: Path) -> None:
    messages = [
        joint_state("/plant/state", START, ("x1", "a1"), (1.0, 2.0), (3.0, NAN), (4.0, 5.0)),
        joint_state("/plant/state", START + 1, ("a1", "x1"), (2.0, 1.0), (NAN, 3.0), (5.0, 4.0), frame="rig"),
        joint_state(
            "/plant/state", START + 2, ("x1", "a1"), (1.0, 2.0), (3.0, NAN), (4.0, 5.0), little=False
        ),
        joint_state("/plant/state", START + 3, ("x1",), (1.0,), (3.0,), (4.0,)),
    ]
    plant = read_recording(mcap_file(tmp_path / "x.mcap", messages)).plant
    np.testing.assert_array_equal(plant.position, [[1, 2], [1, 2], [1, 2], [1, NAN]])
    np.testing.assert_array_equal(plant.effort, [[4, 5], [4, 5], [4, 5], [4, NAN]])
    np.testing.assert_array_equal(plant.stamp_ns, START + np.arange(4))


def test_samples_come_in_time_order_and_once(tmp_path: Path) -> None:
    messages = plant_samples()
    messages[10], messages[11] = messages[11], messages[10]
    recording = read_recording(mcap_file(tmp_path / "x.mcap", [*messages, messages[5]]))
    assert_holds_the_plant(recording.path)
    assert any("order of their stamps" in note for note in recording.notes)
    assert any("last received" in note for note in recording.notes)


def test_a_stamp_decades_away_is_left_out(tmp_path: Path) -> None:
    stray = joint_state("/rthm/plant/state", 2_100_000_000 * 10**9, ("x1", "a1"), (0.0, 0.0))
    recording = read_recording(mcap_file(tmp_path / "x.mcap", [*plant_samples(), stray]))
    assert_holds_the_plant(recording.path)
    assert any("far away" in note for note in recording.notes)


def test_links_say_which_sample_was_used_when(tmp_path: Path) -> None:
    ticks = [START + 12_000_000 * k for k in range(1, 9)]
    uses = [time_reference("/rthm/links/tau2", tick, tick - 8_400_000, "tau2") for tick in ticks]
    recording = read_recording(mcap_file(tmp_path / "x.mcap", [*plant_samples(), *uses]))
    link = recording.links["tau2"]
    np.testing.assert_array_equal(link.use_ns - START, 12_000_000 * np.arange(1, 9))
    assert set((link.use_ns - link.sample_ns).tolist()) == {8_400_000}


def test_a_held_signal_is_a_step() -> None:
    times, values = np.array([10, 20, 30]), np.array([1.0, 2.0, 3.0])
    np.testing.assert_array_equal(
        hold(times, values, np.array([0, 10, 19, 20, 29, 30, 99])), [1, 1, 1, 2, 2, 3, 3]
    )


def test_a_spec_that_cannot_be_read_is_a_note(tmp_path: Path) -> None:
    recording = read_recording(
        mcap_file(tmp_path / "x.mcap", [text("/rthm/spec", "plant: {"), *plant_samples()])
    )
    assert recording.spec is None
    assert any("spec" in note for note in recording.notes)
    with pytest.raises(InputError, match="spec"):
        recording.known_spec()


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "neither"),
        (b"hello, world\n" * 9, "neither"),
        (b"\x89MCAP0\r\n", "no message"),
        (b"SQLite format 3\x00" + b"\x00" * 99, "no message"),
    ],
)
def test_what_is_not_a_bag_is_refused_in_a_sentence(tmp_path: Path, content: bytes, reason: str) -> None:
    file = tmp_path / "some.mcap"
    file.write_bytes(content)
    with pytest.raises(InputError, match=reason):
        read_recording(file)


def test_what_is_not_there_is_refused_in_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        read_recording(tmp_path / "nothing")
    with pytest.raises(InputError, match="without"):
        read_recording(tmp_path)
    other = mcap_file(tmp_path / "other.mcap", [text("/chatter", "hello")])
    with pytest.raises(InputError, match="plant/state"):
        read_recording(other)
