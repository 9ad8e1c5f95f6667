"""Energy balance of recordings against the exact engine."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.energy import EnergyLedger, EnergyResult, energy_of
from rthm_analysis.recording import Recording, read_recording
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, shipped_spec

from .conftest import START, Message, joint_state, mcap_file, text
from .loop import recorded

SPEC = shipped_spec("paper")
TERMS = ("E_num", "E_ff", "E_fx", "E_damping", "E_load", "E_effects")
DURATION = 6.0
NOISE = {
    "noise.position": 1e-4,
    "noise.velocity": 2e-3,
    "noise.motor": 1e-5,
    "noise.force": 0.02,
    "noise.seed": 3,
}


@cache
def messages(changes: tuple[tuple[str, object], ...] = ()) -> list[Message]:
    return recorded(changed(changes), DURATION)


def changed(changes: tuple[tuple[str, object], ...]) -> Spec:
    return apply(SPEC, dict(changes)) if changes else SPEC


def recording(
    folder: Path, *, without: tuple[str, ...] = (), changes: tuple[tuple[str, object], ...] = ()
) -> Recording:
    kept = [m for m in messages(changes) if m[0].removeprefix("/rthm/") not in without]
    return read_recording(mcap_file(folder / "test.mcap", kept))


def energies(result: EnergyResult) -> np.ndarray:
    return np.array([result.work[term][-1] for term in TERMS])


def exact(spec: Spec) -> np.ndarray:
    run = simulate(spec, DURATION, 0.0012)
    return np.array([run.energies[term][-1] for term in TERMS])


def scale(spec: Spec) -> float:
    """Energy that the test began with."""
    return float(simulate(spec, 0.012, 0.012).energies["E_total"][0])


VARIANTS = {
    "paper": (),
    "motor": (("actuator.motor_poles", (400.0, 2000.0)),),
    "prediction": (("actuator.compensator", "polynomial"), ("timing.tau3", 0.0105)),
    "load": (
        ("load.plant.dof", "x1"), ("load.plant.kind", "harmonic"),
        ("load.plant.amplitude", 1.0), ("load.plant.frequency", 2.4),
    ),
}  # fmt: skip


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_energy_balance_of_a_recording_is_that_of_the_exact_engine(tmp_path: Path, variant: str) -> None:
    changes = VARIANTS[variant]
    result = energy_of(recording(tmp_path, changes=changes), None)
    spec = changed(changes)
    np.testing.assert_allclose(energies(result), exact(spec), atol=1e-6 * scale(spec))
    assert np.abs(result.balance_error).max() < 1e-6 * scale(spec)


def test_a_load_that_only_the_recording_knows_is_counted(tmp_path: Path) -> None:
    loaded = changed(VARIANTS["load"])
    silent = text("/rthm/spec", SPEC.expanded(), START)
    kept = [silent if m[0] == "/rthm/spec" else m for m in messages(VARIANTS["load"])]
    result = energy_of(read_recording(mcap_file(tmp_path / "x.mcap", kept)), None)
    np.testing.assert_allclose(energies(result), exact(loaded), atol=1e-5 * scale(loaded))


def test_sensor_noise_changes_the_energy_balance_by_less_than_two_per_cent(tmp_path: Path) -> None:
    noisy = tuple(NOISE.items())
    result = energy_of(recording(tmp_path, changes=noisy), None)
    np.testing.assert_allclose(energies(result), exact(changed(noisy)), atol=0.02 * scale(SPEC))


def test_samples_as_they_come_give_the_same_energy_balance_as_all_at_once(tmp_path: Path) -> None:
    whole = recording(tmp_path)
    at_once = energy_of(whole, None)
    ledger = EnergyLedger(SPEC, whole.start_ns, 0.0012)
    plant, numerical, command = (
        whole.tables[name] for name in ("plant/state", "numerical/state", "actuator/command")
    )
    rows = []
    for begin in np.arange(0.0, DURATION + 0.1, 0.1):
        span = (whole.start_ns + int(begin * 1e9), whole.start_ns + int((begin + 0.1) * 1e9))

        def part(stamps: np.ndarray, span: tuple[int, int] = span) -> np.ndarray:
            return np.flatnonzero((stamps >= span[0]) & (stamps < span[1]))

        p, n, c = (
            plant.rows(part(plant.stamp_ns)),
            numerical.rows(part(numerical.stamp_ns)),
            command.rows(part(command.stamp_ns)),
        )
        ledger.add_plant(p.stamp_ns, *(p.columns(f, ["x1"]) for f in ("position", "velocity", "effort")))
        ledger.add_numerical(n.stamp_ns, n.position, n.velocity)
        ledger.add_commands(c.stamp_ns, c.position, c.effort)
        for name in ("tau2", "tau4"):
            link = whole.links[name]
            of_span = link.rows(part(link.use_ns))
            ledger.add_uses(name, of_span.use_ns, of_span.sample_ns)
        rows.append(ledger.advance(span[1] - 300_000_000))
    rows.append(ledger.advance())
    stamps = np.concatenate([part.stamp_ns for part in rows])
    work = np.concatenate([part.work for part in rows])
    np.testing.assert_array_equal((stamps - whole.start_ns) / 1e9, at_once.t)
    np.testing.assert_allclose(work.T, np.array([at_once.work[term] for term in TERMS]), atol=1e-12)


def test_links_that_are_not_recorded_are_derived_from_the_stamps(tmp_path: Path) -> None:
    result = energy_of(recording(tmp_path, without=("links/tau2", "links/tau4")), None)
    np.testing.assert_allclose(energies(result), exact(SPEC), atol=1e-6)
    assert sum("is not recorded" in note for note in result.notes) == 2


def test_uses_whose_stamps_are_of_another_clock_do_not_silence_the_commands(tmp_path: Path) -> None:
    bag = recording(tmp_path)
    uses = bag.links["tau4"]
    elsewhere = replace(uses, sample_ns=uses.sample_ns + 1_700_000)
    result = energy_of(replace(bag, links=bag.links | {"tau4": elsewhere}), None)
    np.testing.assert_allclose(energies(result), exact(SPEC), atol=1e-6)


def test_without_commands_the_energy_balance_is_that_of_the_plant_and_says_so(tmp_path: Path) -> None:
    result = energy_of(recording(tmp_path, without=("actuator/command",)), None)
    assert np.isnan(result.work["E_fx"]).all()
    assert any("plant alone" in note for note in result.notes)
    assert np.abs(result.balance_error).max() < 0.02 * scale(SPEC)


def test_a_recording_that_begins_within_a_test_has_an_energy_balance_from_there_on(tmp_path: Path) -> None:
    whole = energy_of(recording(tmp_path), None)
    late = [m for m in messages() if m[1] >= START + 1_003_700_000 or m[0].endswith("spec")]
    part = energy_of(read_recording(mcap_file(tmp_path / "late.mcap", late)), None)
    assert any("within a test" in note for note in part.notes)
    begin = np.searchsorted(whole.t, part.t[0] + 1.0044)
    for term in TERMS:
        grown = whole.work[term][-1] - whole.work[term][begin]
        assert part.work[term][-1] == pytest.approx(grown, abs=2e-3)


def test_twenty_lost_samples_do_not_break_the_energy_balance(tmp_path: Path) -> None:
    gap = (START + 2_000_000_000, START + 2_024_000_000)
    kept = [m for m in messages() if not (m[0].endswith("plant/state") and gap[0] < m[1] < gap[1])]
    result = energy_of(read_recording(mcap_file(tmp_path / "gap.mcap", kept)), None)
    np.testing.assert_allclose(energies(result), exact(SPEC), atol=1e-3)


def test_equivalent_damping_is_near_the_first_order_value(tmp_path: Path) -> None:
    result = energy_of(recording(tmp_path), None)
    fx_only = -result.work["E_fx"][-1] / result.passed[-1]
    assert fx_only == pytest.approx(40.0 * (0.0164 + 0.010 - 0.010), rel=0.05)
    assert 0.0 < result.equivalent_damping < fx_only


def test_the_dictionary_has_the_keys_of_the_contract_and_few_rows(tmp_path: Path) -> None:
    told = energy_of(recording(tmp_path), None).as_dict(points=100)
    names = ("t", *TERMS, "E_err", "P_err_estimate", "E_total", "balance_error")
    assert all(len(told[name]) == len(told["t"]) <= 102 for name in names)
    assert told["t"][0] == 0.0
    assert told["t"][-1] == pytest.approx(DURATION)


@pytest.mark.parametrize("velocity", [True, False])
def test_the_energy_balance_of_a_plant_alone_closes(tmp_path: Path, velocity: bool) -> None:
    spec = """/**:
  ros__parameters:
    plant:
      dofs: [x1]
      mass: [2.0]
      damping: [0.3]
      stiffness: [20.0]
      initial_position: [0.1]
      initial_velocity: [0.0]
"""
    run = simulate(shipped_like(spec), 4.0, 0.002)
    rows = zip(run.t, run.plant_position[:, 0], run.plant_velocity[:, 0], strict=True)
    states = [
        joint_state(
            "/rthm/plant/state",
            START + round(t * 1e9),
            ("x1", "a1"),
            (x, float("nan")),
            (v, float("nan")) if velocity else (),
            (float("nan"), 0.0),
        )
        for t, x, v in rows
    ]
    result = energy_of(
        read_recording(mcap_file(tmp_path / "x.mcap", [text("/rthm/spec", spec), *states])), None
    )
    lost = 0.5 * 20.0 * 0.01 - result.total[-1]
    assert result.work["E_damping"][-1] == pytest.approx(-lost, rel=1e-6 if velocity else 1e-2)
    assert np.isnan(result.error).all()


def shipped_like(spec: str) -> Spec:
    from rthm_core.spec import read_spec

    return read_spec(spec)


def test_names_that_do_not_fit_the_spec_are_refused(tmp_path: Path) -> None:
    states = [joint_state("/rthm/plant/state", START + k * 1_200_000, ("y",), (0.0,)) for k in range(10)]
    found = read_recording(mcap_file(tmp_path / "x.mcap", [text("/rthm/spec", SPEC.expanded()), *states]))
    with pytest.raises(InputError, match="x1"):
        energy_of(found, None)


def test_the_energy_balance_of_a_plant_with_friction_stays_within_its_arrays() -> None:
    """Compiled code checks no bounds, so the same code is run as plain Python here."""
    guide = {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.05}
    rubbing = apply(SPEC, {"effects": ["guide"], "guide": guide})
    program = (
        "import sys; from rthm_analysis.energy.rehearsal import rehearse; "
        "from rthm_core.spec import read_spec; rehearse(read_spec(sys.argv[1]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, rubbing.expanded()],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
