"""Whatever a recording holds, its analysis gives results or one sentence."""

from __future__ import annotations

import random
import struct
from collections.abc import Callable
from pathlib import Path

import pytest

from rthm_analysis.bag_analysis import to_json
from rthm_analysis.energy import energy_of
from rthm_analysis.recording import read_recording
from rthm_analysis.report import write_report
from rthm_analysis.timing import timing_of
from rthm_core.errors import InputError
from rthm_core.spec import shipped_spec

from .conftest import Message, mcap_file
from .loop import recorded

Change = Callable[[list[Message], random.Random], list[Message]]
ODD = (float("nan"), float("inf"), -1e300, 1e-320, 0.0)


def without_some(messages: list[Message], chance: random.Random) -> list[Message]:
    return [m for m in messages if chance.random() > 0.2]


def without_topics(messages: list[Message], chance: random.Random) -> list[Message]:
    gone = set(chance.sample(sorted({m[0] for m in messages} - {"/rthm/plant/state"}), 4))
    return [m for m in messages if m[0] not in gone]


def out_of_order(messages: list[Message], chance: random.Random) -> list[Message]:
    return chance.sample(messages, len(messages)) + messages[:9]


def odd_numbers(messages: list[Message], chance: random.Random) -> list[Message]:
    return [_with(m, chance, len(m[3]) - 8, struct.pack("<d", chance.choice(ODD))) for m in messages]


def odd_stamps(messages: list[Message], chance: random.Random) -> list[Message]:
    return [_with(m, chance, 4, struct.pack("<iI", chance.randrange(2**31), 5)) for m in messages]


def slightly_odd_stamps(messages: list[Message], chance: random.Random) -> list[Message]:
    return [_with(m, chance, 8, struct.pack("<I", chance.randrange(10**9))) for m in messages]


def odd_bytes(messages: list[Message], chance: random.Random) -> list[Message]:
    return [_with(m, chance, chance.randrange(len(m[3])), bytes([chance.randrange(256)])) for m in messages]


def _with(message: Message, chance: random.Random, at: int, piece: bytes) -> Message:
    """Message with a piece of its bytes replaced, now and then."""
    topic, received, kind, payload = message
    if topic.endswith("spec") or chance.random() > 0.03:
        return message
    return topic, received, kind, payload[:at] + piece + payload[at + len(piece) :]


CHANGES = (
    without_some,
    without_topics,
    out_of_order,
    odd_numbers,
    odd_stamps,
    slightly_odd_stamps,
    odd_bytes,
)


@pytest.fixture(scope="module")
def whole() -> list[Message]:
    return recorded(shipped_spec("paper"), 0.3)


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
@pytest.mark.parametrize("seed", range(6))
def test_a_damaged_recording_is_analysed_or_refused_in_a_sentence(
    tmp_path: Path, whole: list[Message], change: Change, seed: int
) -> None:
    bag = mcap_file(tmp_path / "x.mcap", change(whole, random.Random(seed)))
    refusal = "."
    try:
        recording = read_recording(bag)
        to_json(timing_of(recording, recording.spec).as_dict())
        to_json(energy_of(recording, recording.spec).as_dict())
    except InputError as reason:
        refusal = str(reason)
    assert refusal.endswith(".")
    assert "\n" not in refusal


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
def test_a_damaged_recording_has_a_page(tmp_path: Path, whole: list[Message], change: Change) -> None:
    bag = mcap_file(tmp_path / "x.mcap", change(whole, random.Random(0)))
    write_report(bag, tmp_path / "x.html")
    assert "</html>" in (tmp_path / "x.html").read_text()
