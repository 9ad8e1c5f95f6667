"""Whatever bytes a file holds, reading it gives a recording or one sentence."""

from __future__ import annotations

import random
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.recording.cdr import decode_joint_states, decode_string, decode_time_references
from rthm_analysis.recording.raw import RawTopic
from rthm_core.errors import InputError

from .conftest import joint_state, mcap_file, plant_samples, rosbag2, text, time_reference

MAGICS = (b"", b"\x89MCAP0\r\n", b"SQLite format 3\x00", b"\x28\xb5\x2f\xfd")


def read_or_refuse(path: Path) -> Recording | None:
    try:
        return read_recording(path)
    except InputError:
        return None


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    folder = tmp_path_factory.mktemp("bags")
    use = time_reference("/rthm/links/tau1", 10**9, 10**9, "tau1")
    messages = [text("/rthm/spec", "plant: 1"), use, *plant_samples(60)]
    return [
        mcap_file(folder / "none.mcap", messages, 2000, "NONE").read_bytes(),
        mcap_file(folder / "zstd.mcap", messages, 2000, "ZSTD").read_bytes(),
        mcap_file(folder / "lz4.mcap", messages, 2000, "LZ4").read_bytes(),
        next(rosbag2(folder / "sql", messages, "sqlite3").glob("*.db3")).read_bytes(),
        next(rosbag2(folder / "packed", messages, "sqlite3", "file").glob("*.zstd")).read_bytes(),
    ]


@settings(max_examples=100, deadline=None)
@given(st.sampled_from(MAGICS), st.binary(max_size=400))
def test_random_bytes_are_refused_in_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, magic: bytes, content: bytes
) -> None:
    file = tmp_path_factory.mktemp("random") / "some.mcap"
    file.write_bytes(magic + content)
    assert read_or_refuse(file) is None


@pytest.mark.parametrize("which", range(5))
@pytest.mark.parametrize("seed", range(25))
def test_a_file_with_changed_bytes_is_read_or_refused(
    tmp_path: Path, files: list[bytes], which: int, seed: int
) -> None:
    chance = random.Random(1000 * which + seed)
    content = bytearray(files[which])
    for _ in range(chance.choice([1, 3, 30])):
        content[chance.randrange(len(content))] = chance.choice([0, 255, chance.randrange(256)])
    file = tmp_path / "changed.mcap"
    file.write_bytes(content)
    read_or_refuse(file)


@pytest.mark.parametrize("which", range(5))
@pytest.mark.parametrize("share", [0.01, 0.1, 0.33, 0.5, 0.9, 0.99])
def test_a_file_that_ends_anywhere_is_read_or_refused(
    tmp_path: Path, files: list[bytes], which: int, share: float
) -> None:
    file = tmp_path / "cut.mcap"
    file.write_bytes(files[which][: int(share * len(files[which]))])
    read_or_refuse(file)


def _topic(payload: bytes) -> RawTopic:
    topic = RawTopic("/x", "")
    topic.append(0, payload)
    return topic


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_a_message_with_changed_bytes_is_decoded_or_left_out(data: st.DataObject) -> None:
    payload = bytearray(joint_state("/x", 5, ("x1", "a1"), (1.0, 2.0), (3.0, 4.0), (5.0, 6.0))[3])
    for _ in range(data.draw(st.integers(1, 6))):
        payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    payload = payload[: data.draw(st.integers(0, len(payload)))]
    for block in decode_joint_states(_topic(bytes(payload))):
        assert all(values.shape[0] == 1 for values in block.values.values())
    list(decode_time_references(_topic(bytes(payload))))
    with suppress(ValueError):
        decode_string(bytes(payload))
