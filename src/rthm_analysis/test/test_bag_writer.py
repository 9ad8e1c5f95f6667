"""The writer of recordings: what other readers find in its files, and what is left of one that was cut."""

from __future__ import annotations

import contextlib
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader

from rthm_analysis.recording.writing import BagWriter
from rthm_core.errors import InputError

STRING = "std_msgs/msg/String"
TEXT = b"\x00\x01\x00\x00\x04\x00\x00\x00abc\x00"


def test_every_reader_finds_what_was_written(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as bag:
        bag.add_topic("/rthm/spec", STRING, depth=1, latched=True)
        bag.write("/rthm/spec", STRING, TEXT, 20, 10)
        bag.write("/rthm/other", STRING, TEXT, 30, 11, sequence=7)
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        found = [
            (
                schema.name,
                schema.encoding,
                channel.topic,
                message.log_time,
                message.publish_time,
                message.sequence,
            )
            for schema, channel, message in reader.iter_messages()
        ]
    assert found == [
        (STRING, "ros2msg", "/rthm/spec", 20, 10, 1),
        (STRING, "ros2msg", "/rthm/other", 30, 11, 7),
    ]
    with AnyReader([tmp_path / "bag"]) as reader:
        read = [(c.topic, t, reader.deserialize(raw, c.msgtype).data) for c, t, raw in reader.messages()]
    assert read == [("/rthm/spec", 20, "abc"), ("/rthm/other", 30, "abc")]


def test_metadata_is_that_of_version_9(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as bag:
        bag.add_topic("/rthm/spec", STRING, depth=1, latched=True)
        bag.write("/rthm/spec", STRING, TEXT, 20, 10)
        bag.write("/rthm/spec", STRING, TEXT, 50, 10)
        bag.custom["lost"] = "0"
    content = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert content["version"] == 9
    assert content["storage_identifier"] == "mcap"
    assert content["relative_file_paths"] == ["bag_0.mcap"]
    assert content["duration"] == {"nanoseconds": 30}
    assert content["message_count"] == 2
    assert content["custom_data"] == {"lost": "0"}
    topic = content["topics_with_message_count"][0]["topic_metadata"]
    assert topic["offered_qos_profiles"][0]["durability"] == "transient_local"
    assert topic["type_description_hash"].startswith("RIHS01_")


def test_what_was_flushed_survives_without_a_close(tmp_path: Path) -> None:
    bag = BagWriter(tmp_path / "bag")
    for k in range(1000):
        bag.write("/rthm/spec", STRING, TEXT, k, k)
    bag.flush()
    bag.write("/rthm/spec", STRING, TEXT, 1000, 1000)
    left = shutil.copy(tmp_path / "bag" / "bag_0.mcap", tmp_path)
    bag.close()
    assert _times_in(Path(left)) == list(range(1000))


def _times_in(path: Path) -> list[int]:
    """Read without the index, up to the cut."""
    times = []
    with path.open("rb") as stream, contextlib.suppress(McapError):
        for record in StreamReader(stream).records:
            if isinstance(record, Message):
                times.append(record.log_time)
    return times


@settings(max_examples=20, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 2**62), st.integers(0, 2**62), st.text(max_size=40)), max_size=30))
def test_a_round_trip_equals_memory(
    tmp_path_factory: pytest.TempPathFactory, messages: list[tuple[int, int, str]]
) -> None:
    folder = tmp_path_factory.mktemp("round") / "bag"
    expected = [(received, sent, _cdr(text)) for received, sent, text in messages]
    with BagWriter(folder) as bag:
        for received, sent, data in expected:
            bag.write("/rthm/spec", STRING, data, received, sent)
    with next(folder.glob("*.mcap")).open("rb") as stream:
        read = make_reader(stream).iter_messages(log_time_order=False)
        assert [(m.log_time, m.publish_time, m.data) for *_, m in read] == expected


def _cdr(text: str) -> bytes:
    data = text.encode() + b"\x00"
    return b"\x00\x01\x00\x00" + struct.pack("<I", len(data)) + data


def test_a_folder_with_something_in_it_is_refused(tmp_path: Path) -> None:
    (tmp_path / "kept").write_text("precious")
    with pytest.raises(InputError, match="not empty"):
        BagWriter(tmp_path)


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"cannot be written to .*\(not a directory\)"):
        BagWriter(tmp_path / "file" / "bag")


FILL_THE_DISK = """
import resource, sys
from rthm_analysis.recording.writing import BagWriter
from rthm_core.errors import InputError
resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
bag = BagWriter(sys.argv[1])
try:
    for k in range(10_000):
        bag.write(sys.argv[2].format(k), "std_msgs/msg/String", bytes(64), k, k)
    bag.flush()
except InputError as error:
    print(error)
"""


@pytest.mark.parametrize("topic", ["/rthm/spec", "/rthm/spec{}"], ids=["one topic", "ever new topics"])
def test_a_file_that_can_grow_no_more_is_one_sentence(tmp_path: Path, topic: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FILL_THE_DISK, str(tmp_path / "bag"), topic],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "cannot be written" in done.stdout
    assert "file too large" in done.stdout
    assert done.stderr == ""
