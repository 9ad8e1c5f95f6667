from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState, TimeReference

from rthm_core.ros.messages import JointStateReader, JointStateWriter, TimeReferenceWriter

NAME = st.text("abcdefghij_0123456789", min_size=1, max_size=9)
NAMES = st.lists(NAME, min_size=1, max_size=5, unique=True)
STAMPS = st.integers(0, 2_000_000_000 * 10**9)
Message = tuple[list[str], int, list[list[float]]]


@st.composite
def joint_states(draw: st.DrawFn) -> Message:
    names = draw(NAMES)
    row = st.lists(st.floats(), min_size=len(names), max_size=len(names))
    return names, draw(STAMPS), [draw(row) for _ in range(3)]


@given(joint_states())
def test_the_middleware_reads_what_the_writer_packed(message: Message) -> None:
    names, stamp, fields = message
    read = deserialize_message(JointStateWriter(names).bytes(stamp, *fields), JointState)
    assert read.name == names
    assert read.header.stamp.sec * 10**9 + read.header.stamp.nanosec == stamp
    for got, sent in zip((read.position, read.velocity, read.effort), fields, strict=True):
        assert [repr(value) for value in got] == [repr(value) for value in sent]


@given(joint_states(), st.data())
def test_the_reader_gives_what_another_program_sent_in_its_own_order_of_names(
    message: Message, data: st.DataObject
) -> None:
    names, stamp, (position, _, effort) = message
    sent = JointState(name=names, position=position, velocity=[], effort=effort)
    sent.header.frame_id = data.draw(st.sampled_from(["", "tank", "basin3"]))
    sent.header.stamp.sec, sent.header.stamp.nanosec = divmod(stamp, 10**9)
    wanted = data.draw(st.permutations(names))
    reader = JointStateReader(wanted)
    for _ in range(2):
        got = reader.sample(serialize_message(sent))
        assert got.stamp == stamp
        assert repr(got.position) == repr([position[names.index(name)] for name in wanted])
        assert repr(got.effort) == repr([effort[names.index(name)] for name in wanted])
        assert all(math.isnan(value) for value in got.velocity)


@given(STAMPS, STAMPS)
def test_the_middleware_reads_the_use_of_a_sample(stamp: int, reference: int) -> None:
    read = deserialize_message(TimeReferenceWriter("tau3").bytes(stamp, reference), TimeReference)
    assert read.source == "tau3"
    assert read.header.stamp.sec * 10**9 + read.header.stamp.nanosec == stamp
    assert read.time_ref.sec * 10**9 + read.time_ref.nanosec == reference


def test_a_message_that_leaves_a_name_out_is_refused() -> None:
    data = JointStateWriter(["x1"]).bytes(0, [1.0], [2.0], [3.0])
    with pytest.raises(ValueError, match="names x1, but not a1"):
        JointStateReader(["x1", "a1"]).sample(data)


@given(st.binary(max_size=60), st.integers(0, 120))
def test_bytes_that_are_no_message_are_refused(noise: bytes, length: int) -> None:
    whole = JointStateWriter(["x1", "a1"]).bytes(5, [1.0, 2.0], [3.0, 4.0], [5.0, 6.0])
    reader = JointStateReader(["x1"])
    for data in (noise, whole[: min(length, len(whole) - 1)]):
        with pytest.raises(ValueError, match=r"is|names|has"):
            reader.sample(data)
