"""The energy balance of a running test is that of its recording."""

from __future__ import annotations

import random

import numpy as np

from rthm_analysis.energy import energy_of
from rthm_analysis.live import TOPICS, LiveLedger
from rthm_analysis.recording import read_recording
from rthm_core.energy import TERMS
from rthm_core.spec import shipped_spec

from .conftest import mcap_file
from .loop import recorded

SPEC = shipped_spec("paper")


def test_a_live_ledger_agrees_with_the_recording_whatever_order_messages_come_in(tmp_path) -> None:
    messages = recorded(SPEC, 3.0)
    whole = energy_of(read_recording(mcap_file(tmp_path / "x.mcap", messages)), None)
    chance = random.Random(5)
    arriving = sorted(messages, key=lambda message: message[1] + chance.randrange(50_000_000))
    ledger, told, next_count = LiveLedger(SPEC), [], 0
    for topic, stamp, _, payload in arriving:
        name = topic.removeprefix("/rthm/")
        if name in TOPICS:
            ledger.take(name, payload)
        if stamp > next_count:
            next_count = stamp + 100_000_000
            told += [ledger.advance()]
    told += [ledger.advance(final=True)]
    balance = dict(entry for entry in told if entry is not None)
    start = min(message[1] for message in messages)
    assert len(balance) > 20
    for stamp, terms in balance.items():
        row = np.searchsorted(whole.t, (stamp - start) * 1e-9 - 1e-7)
        for term in TERMS:
            assert abs(terms[term] - whole.work[term][row]) < 1e-9
        assert abs(terms["balance_error"] - whole.balance_error[row]) < 1e-9


def test_nothing_is_told_before_the_plant_moves() -> None:
    ledger = LiveLedger(SPEC)
    assert ledger.advance() is None
    assert ledger.advance(final=True) is None


def test_a_stamp_a_day_ahead_is_not_waited_for() -> None:
    messages = recorded(SPEC, 2.0)
    ledger, told = LiveLedger(SPEC), None
    start = min(message[1] for message in messages)
    for topic, stamp, _, payload in sorted(messages, key=lambda message: message[1]):
        name = topic.removeprefix("/rthm/")
        if name in TOPICS:
            ledger.take(name, payload)
        if name == "plant/state" and (stamp - start) % 120_000_000 == 0:
            told = ledger.advance() or told
            days = int.from_bytes(payload[4:8], "little") + 86_400
            ledger.take(name, payload[:4] + days.to_bytes(4, "little") + payload[8:])
    assert told is not None
    last = ledger.advance(final=True)
    assert last is not None
    assert last[0] - start < 3_000_000_000
