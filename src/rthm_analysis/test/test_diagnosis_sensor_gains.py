"""A position or a velocity that reads too much is told by the other and the known force, whatever rubs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis.diagnose import diagnose
from rthm_analysis.diagnosis.faults.sensor_gains import find_gains, part_of_force
from rthm_analysis.diagnosis.physical.gains_told import gains_told
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.exchange.bag import write_bag
from rthm_analysis.recording import Recording, Table, read_recording
from rthm_analysis.recording.cdr import FIELDS
from rthm_core.topics import PLANT_STATE

from .faulty import PLAIN, POSITION, VELOCITY, changed, having, later
from .faulty import plain as linear
from .plain import plant, recorded

GAIN = 1.05


def braked(t: float, x: float, v: float) -> float:
    return -0.15 * np.tanh(v / 1e-3) if t > 9.0 else 0.0


def bag(path: Path, evidence: Evidence) -> Recording:
    """Position, velocity and known force of a plant alone."""
    known = {"effort": evidence.load}
    known |= {family: evidence.measured[:, [k]] for k, family in enumerate(("position", "velocity"))}
    stamps, none = evidence.stamps_ns, np.full((evidence.stamps_ns.size, 1), np.nan)
    columns = {field: known.get(field, none) for field in FIELDS}
    write_bag(path, {PLANT_STATE: Table(stamps, stamps, stamps, ("x1",), **columns)}, {}, "")
    return read_recording(path)


@pytest.mark.parametrize(("column", "family"), [(POSITION, "position"), (VELOCITY, "velocity")])
def test_the_sensor_that_reads_too_much_is_told_beside_a_brake(column: int, family: str) -> None:
    seen = changed(recorded(braked), column, lambda read: GAIN * read)
    (one,) = find_gains(seen, plant())
    assert one.channel == Channel(family, "x1")
    assert abs(one.factor - GAIN) < 3.0 * one.std < 0.01


@pytest.mark.parametrize(
    "seen",
    [
        recorded(braked),
        linear(having(PLAIN, "sensor.position", "lag", time_constant=0.012)),
        later(linear(), POSITION, 0.018),
        changed(linear(), POSITION, lambda read: read + 0.3 * read**2),
    ],
    ids=["brake", "lag", "delay", "bend"],
)
def test_what_is_no_gain_is_not_told_as_one(seen: Evidence) -> None:
    spec = plant() if seen.time[-1] > 20.0 else PLAIN
    assert not find_gains(seen, spec)


def test_where_mass_and_stiffness_are_uncertain_nobody_knows_which_sensor_it_is() -> None:
    seen = changed(recorded(), POSITION, lambda read: GAIN * read)
    assert [one.instead for one in find_gains(seen, plant())] == [None]
    (one,) = find_gains(seen, plant(mass=0.03, stiffness=0.03))
    assert {one.channel.family, one.instead.family} == {"position", "velocity"}
    (note,) = gains_told([one]).notes
    assert "the velocity of x1 reads 0.952" in note


def test_stretches_that_do_not_agree_say_nothing_of_a_force() -> None:
    asked, velocity = np.random.default_rng(0).normal(size=(2, 4000))
    assert part_of_force(0.95 * asked - np.sign(velocity), asked, velocity) == pytest.approx(0.95)
    assert part_of_force(np.linspace(-1.0, 1.0, 4000) * asked, asked, velocity) is None


@pytest.mark.long
def test_a_gain_and_a_brake_are_told_together(tmp_path: Path) -> None:
    seen = changed(recorded(braked), POSITION, lambda read: GAIN * read)
    found = diagnose(bag(tmp_path / "bag", seen), plant())
    assert [(one.block, one.kind) for one in found.physics] == [("sensor.position", "scale")]
    assert {"v", "t"} == set(found.described[0].depends_on)


def test_a_gain_alone_explains_a_recording(tmp_path: Path) -> None:
    seen = changed(recorded(), POSITION, lambda read: GAIN * read)
    found = diagnose(bag(tmp_path / "bag", seen), plant())
    assert found.verdict == "explained" and [one.kind for one in found.physics] == ["scale"]
    assert "scale: 1.0" in found.patched
