"""A measured acceleration: one more signal of a dof, with an offset of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis.diagnose import diagnose
from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.joining import joined
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence, gather
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.joint import one_after_the_other
from rthm_analysis.diagnosis.result import Diagnosis, Value
from rthm_analysis.exchange.bag import write_bag
from rthm_analysis.recording import Recording, Table, read_recording
from rthm_analysis.recording.cdr import FIELDS
from rthm_core.errors import InputError
from rthm_core.physical.side import PhysicalSide
from rthm_core.spec import Spec, apply, spec_from_parameters
from rthm_core.topics import ACCELERATION, PLANT_STATE

from .faulty import PLAIN, having, plain
from .plain import accelerated, from_rest, plant

POSITION, VELOCITY, MEASURED = range(3)


def seen(evidence: Evidence, *columns: int) -> Evidence:
    return replace(
        evidence,
        channels=tuple(evidence.channels[k] for k in columns),
        measured=evidence.measured[:, list(columns)],
    )


def diagnosed(evidence: Evidence, spec: Spec | None = None) -> Diagnosis:
    spec = spec or plant()
    found = diagnose_physical(evidence, spec, np.empty(0), lambda said: None)
    return joined([physical_part(found)], spec)


def bag(path: Path, evidence: Evidence, late_ns: int = 0) -> Recording:
    """Position, force and acceleration of a plant alone, the latter with stamps of its own."""
    stamps = evidence.stamps_ns

    def table(at: np.ndarray, **known: np.ndarray) -> Table:
        none = np.full((stamps.size, 1), np.nan)
        return Table(at, at, at, ("x1",), **{field: known.get(field, none) for field in FIELDS})

    state = table(stamps, position=evidence.measured[:, :1], effort=evidence.load)
    beside = table(stamps + late_ns, effort=evidence.measured[:, MEASURED:])
    write_bag(path, {PLANT_STATE: state, ACCELERATION: beside}, {}, "")
    return read_recording(path)


def with_accelerometer(spec: Spec = PLAIN, seed: int = 0) -> Evidence:
    """Position, velocity and acceleration under a known force; a stop of the spec acts on the latter."""
    exact = plain(spec, seed=seed, noise=0.0)
    x, v = exact.measured.T
    true = (exact.load[:, 0] - 0.3 * v - 12.0 * x + sum(_stop(e.numbers, x, v) for e in spec.effects)) / 1.2
    noise = np.random.default_rng(50 + seed).normal(size=(x.size, 3)) * (1e-4, 2e-3, 0.02)
    channels = (*exact.channels, Channel("acceleration", "x1"))
    return replace(exact, channels=channels, measured=np.column_stack([x, v, true + 0.3]) + noise)


def _stop(numbers: dict[str, float], x: np.ndarray, v: np.ndarray) -> np.ndarray:
    push = -numbers["stiffness"] * (x - numbers["position"]) - numbers["damping"] * v
    return np.where(x > numbers["position"], push, 0.0)


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [
        ("end_stop", {"position": 0.1, "stiffness": 2000.0, "damping": 2.0}),
        ("coulomb_friction", {"force": 0.3}),
        ("cubic_stiffness", {"coefficient": 50.0}),
    ],
)
def test_the_replay_has_the_acceleration_of_the_simulator(kind: str, parameters: dict[str, float]) -> None:
    spec = having(PLAIN, "plant", kind, **parameters)
    exact = plain(spec, noise=0.0)
    x, v = exact.measured.T
    force = {
        "end_stop": _stop,
        "coulomb_friction": lambda p, x, v: -p["force"] * np.sign(v),
        "cubic_stiffness": lambda p, x, v: -p["coefficient"] * x**3,
    }[kind](parameters, x, v)
    true = (exact.load[:, 0] - 0.3 * v - 12.0 * x + force) / 1.2
    motion = Experiment(exact, np.empty(0)).motion(spec, from_rest().moved(0, 0.05))
    assert motion.acceleration[1:, 0] == pytest.approx(true[1:], abs=1e-5 * float(np.abs(true).max()))


def test_noise_and_an_offset_are_no_physics() -> None:
    found = diagnosed(accelerated())
    assert found.verdict == "match" and not found.physics and not found.retuned
    (note,) = (note for note in found.notes if "offset" in note)
    assert float(note.split()[3]) == pytest.approx(0.3, abs=0.005)
    assert "acc1" in [fit.signal for fit in found.fits]


def test_the_offset_of_unseen_data_is_that_of_the_fitted_ones() -> None:
    clean = accelerated(noise=0.0)
    measured = clean.measured.copy()
    measured[clean.trained :, MEASURED] += 1.0
    evidence = replace(clean, measured=measured)
    left = measured - Experiment(evidence, np.empty(0), seen=evidence.trained).predicted(plant(), from_rest())
    assert np.abs(left[: clean.trained, MEASURED]).max() < 1e-3
    assert left[clean.trained :, MEASURED] == pytest.approx(1.0, abs=1e-3)


def test_each_recording_has_an_offset_of_its_own() -> None:
    several = [accelerated(seed=seed, offset=offset) for seed, offset in ((0, 0.3), (1, -0.2), (2, 0.5))]
    found = diagnosed(one_after_the_other(several, ["a", "b", "c"], np.empty(0)))
    assert found.verdict == "match"
    told = [note for note in found.notes if "offset" in note]
    assert [note.partition("x1 in ")[2][0] for note in told] == ["a", "b", "c"]
    assert [float(note.split()[3]) for note in told] == pytest.approx([0.3, -0.2, 0.5], abs=0.005)


def test_an_accelerometer_that_drifts_is_told_with_its_offset() -> None:
    clean = seen(accelerated(), POSITION, MEASURED)
    drift = np.column_stack([np.zeros(clean.time.size), 0.01 * clean.time])
    found = diagnosed(replace(clean, measured=clean.measured + drift))
    (one,) = found.physics
    rate = one.parameters["rate"]
    assert (one.block, one.kind) == ("sensor.acceleration", "drift") and isinstance(rate, Value)
    assert rate.value == pytest.approx(0.01, rel=0.1)
    (note,) = (note for note in found.notes if "offset" in note)
    assert float(note.split()[3]) == pytest.approx(0.3, abs=0.01)


def test_an_accelerometer_that_loses_what_is_slow_is_where_the_error_is() -> None:
    clean = seen(accelerated(), POSITION, MEASURED)
    slow = np.zeros(clean.time.size)
    for i, reading in enumerate(clean.measured[:-1, 1]):
        slow[i + 1] = slow[i] + 2.0 * np.pi * 0.1 * 0.005 * (reading - slow[i])
    measured = np.column_stack([clean.measured[:, 0], clean.measured[:, 1] - slow])
    found = diagnosed(replace(clean, measured=measured))
    assert not found.physics and not found.described and not found.retuned
    assert found.located == ("sensor.acceleration",)


@pytest.mark.long
def test_a_contact_is_known_better_with_the_acceleration() -> None:
    stop = {"position": 0.1, "stiffness": 2000.0, "damping": 2.0}
    evidence = with_accelerometer(having(PLAIN, "plant", "end_stop", **stop), seed=1).kept(slice(5000))
    found = [diagnosed(seen(evidence, *columns), PLAIN) for columns in ((POSITION,), (POSITION, MEASURED))]
    stds = []
    for one in found:
        (end,) = one.physics
        stiffness = end.parameters["stiffness"]
        assert end.kind == "end_stop" and isinstance(stiffness, Value)
        assert abs(stiffness.value - 2000.0) < 4.0 * stiffness.std
        stds.append(stiffness.std)
    assert found[1].verdict == "explained" and stds[1] < 0.1 * stds[0]


@pytest.mark.parametrize("columns", [(POSITION, VELOCITY, MEASURED), (POSITION, MEASURED)])
@pytest.mark.parametrize("gain", [0.9, 1.1])
def test_a_gain_of_the_accelerometer_is_no_physics_of_the_plant(
    columns: tuple[int, ...], gain: float
) -> None:
    evidence = seen(accelerated(gain=gain), *columns)
    assert not mend(evidence, plant()).faults  # it is no unit
    found = diagnosed(evidence, plant(mass=0.1, damping=0.5, stiffness=0.1))
    (one,) = found.physics
    scale = one.parameters["scale"]
    assert (one.block, one.kind, one.place) == ("sensor.acceleration", "scale", "x1")
    assert isinstance(scale, Value) and abs(scale.value - gain) < 4.0 * scale.std < 0.02
    assert found.located == ("sensor.acceleration",) and one.words.startswith("The accelerometer of x1")


@pytest.mark.parametrize("columns", [(POSITION, VELOCITY, MEASURED), (POSITION, MEASURED)])
@pytest.mark.parametrize(
    ("factor", "kind"), [(-1.0, "sign"), (1.0 / 9.80665, "unit"), (1e3, "unit"), (-100.0, "unit")]
)
def test_sign_and_unit_of_an_acceleration_are_told_by_the_motion(
    columns: tuple[int, ...], factor: float, kind: str
) -> None:
    right = seen(accelerated(), *columns)
    measured = right.measured.copy()
    measured[:, -1] *= factor
    mended = mend(replace(right, measured=measured), plant())
    (fault,) = mended.faults
    assert (fault.block, fault.kind, fault.channel) == ("sensor.acceleration", kind, "x1.acceleration")
    assert fault.value == pytest.approx(factor)
    assert mended.evidence.measured == pytest.approx(right.measured)


@pytest.mark.parametrize("columns", [(POSITION, VELOCITY, MEASURED), (POSITION, MEASURED)])
def test_an_acceleration_that_comes_late_is_moved_back(columns: tuple[int, ...]) -> None:
    right = seen(with_accelerometer(), *columns)
    assert not mend(right, PLAIN).faults
    measured = right.measured.copy()
    measured[:, -1] = np.roll(measured[:, -1], 8)
    (fault,) = mend(replace(right, measured=measured), PLAIN).faults
    assert (fault.channel, fault.kind) == ("x1.acceleration", "channel_delay")
    assert fault.value == pytest.approx(8 * 1.2e-3, rel=0.05)


def test_an_impact_is_no_spike_and_rest_no_drop_out() -> None:
    bounces = accelerated(lambda t, x, v: -2e5 * (x - 0.12) if x > 0.12 else 0.0, noise=0.0)
    sticks = accelerated(lambda t, x, v: -0.5 * np.tanh(1e4 * v), noise=0.0)
    for one in (bounces, sticks):
        assert not [fault for fault in mend(one, plant()).faults if fault.block == "sensor.acceleration"]


def test_of_two_dofs_one_may_have_a_position_and_the_other_an_acceleration() -> None:
    mass, damping, stiffness = [1.2, 0.0, 0.0, 0.8], [0.3, -0.1, -0.1, 0.2], [40.0, -15.0, -15.0, 25.0]
    section = {"dofs": ["x1", "x2"], "mass": mass, "damping": damping, "stiffness": stiffness}
    load = {"dof": "x1", "kind": "multisine", "rms": 1.0, "low": 1.0, "high": 8.0, "count": 15, "seed": 2}
    spec = spec_from_parameters(
        {"plant": section | {"initial_position": [0.0, 0.0], "initial_velocity": [0.0, 0.0]}}
    )
    side, stamps = PhysicalSide(apply(spec, {"load.plant": load})), np.arange(4000) * 5_000_000
    samples = [side.sample(stamp) for stamp in stamps.tolist()]
    x, v = (np.array([getattr(one, name) for one in samples]) for name in ("position", "velocity"))
    forces = np.array([one.load for one in samples])
    held = v @ np.reshape(damping, (2, 2)) + x @ np.reshape(stiffness, (2, 2))
    true = np.column_stack([x[:, 0], (forces[:, 1] - held[:, 1]) / 0.8 + 0.4])
    noise = np.random.default_rng(1).normal(size=true.shape) * (1e-4, 0.03)
    channels = Channel("position", "x1"), Channel("acceleration", "x2")
    nothing = np.empty(0, dtype=np.int64), np.empty((0, 0))
    found = diagnosed(Evidence(stamps, *nothing, forces, channels, true + noise, "force"), spec)
    assert found.verdict == "match" and any("acceleration of x2" in note for note in found.notes)


def test_a_bag_with_an_acceleration_is_diagnosed(tmp_path: Path) -> None:
    found = diagnose(bag(tmp_path / "bag", accelerated(lambda t, x, v: -0.05 * np.sign(v))), plant())
    (one,) = found.physics
    assert found.verdict == "explained" and one.kind == "coulomb_friction"
    assert {fit.signal for fit in found.fits} == {"x1", "acc1"}


def test_an_acceleration_at_other_instants_is_told_and_left_out(tmp_path: Path) -> None:
    evidence = gather(bag(tmp_path / "bag", accelerated(duration=3.0), late_ns=1_000_000), plant())
    assert evidence.channels == (Channel("position", "x1"),)
    assert any("resample both to the same instants" in note for note in evidence.notes)


def test_an_acceleration_alone_is_too_little(tmp_path: Path) -> None:
    recording = bag(tmp_path / "bag", accelerated(duration=3.0))
    state = replace(recording.plant, position=np.full_like(recording.plant.position, np.nan))
    alone = replace(recording, tables=recording.tables | {PLANT_STATE: state})
    with pytest.raises(InputError, match="the acceleration of its plant alone") as said:
        diagnose(alone, plant())
    assert "\n" not in str(said.value)
