"""A first spec from a recording: its numbers are those of the rig, and a diagnosis agrees with it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis import diagnose
from rthm_analysis.diagnosis.joining import patched_spec
from rthm_analysis.diagnosis.result import Part
from rthm_analysis.first_spec import draft_of
from rthm_analysis.first_spec.timing import period, simplest
from rthm_analysis.recording import Recording, Table, read_recording
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, number_at, numbers, parameters, read_spec, shipped_spec

from .conftest import mcap_file
from .loop import recorded as loop_messages
from .plain import DAMPING, MASS, STIFFNESS, recorded


def plain(**options: object) -> Recording:
    """Position, velocity and load of a linear plant with the reference noise."""
    evidence = recorded(**options)  # type: ignore[arg-type]
    stamps = evidence.stamps_ns
    x, v = (evidence.measured[:, i : i + 1] for i in (0, 1))
    table = Table(stamps, stamps, stamps, ("x1",), x, v, evidence.load)
    return Recording(Path("bag"), "/rthm", None, "", {"plant/state": table}, {}, int(stamps[0]), ())


NOISE = {"position": 1e-4, "velocity": 2e-3, "motor": 1e-5, "force": 0.02, "seed": 1}


def loop(folder: Path, spec: Spec, duration: float = 12.0) -> Recording:
    """A hybrid test of which nobody recorded the spec."""
    messages = [one for one in loop_messages(spec, duration) if one[0] != "/rthm/spec"]
    return read_recording(mcap_file(folder / "loop.mcap", messages))


def near(found: float, true: float, relative: float) -> bool:
    """Within 3 standard deviations, or 5 %."""
    return abs(found / true - 1.0) < max(3.0 * relative, 0.05)


@pytest.mark.parametrize("seed", range(3))
def test_a_driven_plant_is_found_with_its_mass(seed: int) -> None:
    recording = plain(seed=seed)
    draft = draft_of(recording)
    spec = read_spec(draft.text("bag"))
    assert spec == draft.spec and not draft.told and spec.plant.dofs == ("x1",)
    spread = spec.uncertainty.plant
    assert near(spec.plant.mass[0], MASS, spread.mass) and 0.0 < spread.mass < 0.01
    assert near(spec.plant.damping[0], DAMPING, spread.damping)
    assert near(spec.plant.stiffness[0], STIFFNESS, spread.stiffness) and 0.0 < spread.stiffness < 0.01
    assert spec.timing is not None and spec.timing.td1 == 0.005
    assert diagnose(recording, spec).verdict in ("match", "retuned")


def test_a_free_decay_tells_everything_but_the_mass() -> None:
    recording = plain(force=0.0, start=0.4)
    draft = draft_of(recording)
    spec = draft.spec
    assert "assumed to be exactly 1 kg" in draft.told[0] and "assumed to be exactly 1 kg" in draft.text("bag")
    assert spec.plant.mass == (1.0,) and spec.uncertainty.plant.mass == 0.0
    assert spec.plant.stiffness[0] == pytest.approx(STIFFNESS / MASS, rel=1e-3)
    assert spec.plant.initial_position[0] == pytest.approx(0.4, abs=2e-4)
    assert diagnose(recording, spec).verdict in ("match", "retuned")
    weighed = draft_of(recording, masses=[MASS]).spec
    assert weighed.plant.mass == (MASS,)
    assert weighed.plant.stiffness[0] == pytest.approx(STIFFNESS, rel=1e-3)
    assert near(weighed.plant.damping[0], DAMPING, weighed.uncertainty.plant.damping)


def test_a_load_that_is_held_between_its_samples_is_no_damping() -> None:
    """With straight lines between them it would come half a sample late: K h / 2 = 0.03 N s/m of damping."""
    recording = plain()
    table = recording.plant
    load = np.vstack([table.effort[1:], table.effort[-1:]])
    shifted = replace(table, effort=0.5 * (table.effort + load))  # what acted on from each sample to the next
    found = draft_of(replace(recording, tables={"plant/state": shifted})).spec
    assert found.plant.damping[0] == pytest.approx(DAMPING, rel=0.1)


def test_friction_widens_the_uncertainty_and_is_found_by_the_diagnosis() -> None:
    recording = plain(law=lambda t, x, v: -0.05 * float(np.sign(v)), force=0.0, start=0.4)
    draft = draft_of(recording, masses=[MASS])
    assert draft.spec.uncertainty.plant.damping > 0.01
    found = diagnose(recording, draft.spec)
    assert found.verdict == "explained" and [one.kind for one in found.physics] == ["coulomb_friction"]


@pytest.mark.parametrize("name", ["paper", "paper_noisy"])
def test_a_loop_is_found_from_what_its_parts_computed(tmp_path: Path, name: str) -> None:
    true = shipped_spec(name)
    recording = loop(tmp_path, true)
    draft = draft_of(recording)
    spec = read_spec(draft.text("bag"))
    assert spec.timing == true.timing
    for key in numbers(true):
        if key.startswith(("numerical.", "interface.", "actuator.")):
            assert number_at(spec, key) == pytest.approx(number_at(true, key), rel=1e-6, abs=1e-9), key
    spread = spec.uncertainty.plant
    assert near(spec.plant.mass[0], 1.2, spread.mass)
    assert near(spec.plant.damping[0], 0.05, spread.damping)
    assert near(spec.plant.stiffness[0], 12.0, spread.stiffness)
    assert any("motor_poles" in sentence for sentence in draft.told)
    assert diagnose(recording, spec).verdict in ("match", "retuned")


def test_ticks_that_are_late_in_real_time_hide_nothing(tmp_path: Path) -> None:
    true = shipped_spec("paper")
    whole, rng = loop(tmp_path, true), np.random.default_rng(0)
    for name in ("tau1", "tau2", "tau3"):
        link = whole.links[name]
        late = 2_000 + np.rint(rng.exponential(20_000.0, len(link))).astype(np.int64)
        whole = replace(whole, links=whole.links | {name: replace(link, use_ns=link.use_ns + late)})
    spec = draft_of(whole).spec
    assert spec.timing == true.timing
    assert spec.numerical.stiffness == pytest.approx([6.0]) and spec.k_tot == pytest.approx([40.0])


def test_a_loop_of_several_dofs_and_actuators_is_found(tmp_path: Path) -> None:
    true = shipped_spec("three_mass")
    recording = loop(tmp_path, apply(true, {"noise": NOISE}))
    spec = draft_of(recording).spec
    assert spec.interface == true.interface and spec.timing == true.timing
    assert spec.numerical.mass == pytest.approx(true.numerical.mass, rel=1e-6)
    assert spec.numerical.damping == pytest.approx(true.numerical.damping, abs=1e-6)
    for name in ("mass", "damping", "stiffness"):
        assert getattr(spec.plant, name) == pytest.approx(getattr(true.plant, name), rel=0.02, abs=0.01)


@pytest.mark.long
def test_a_diagnosis_agrees_with_a_first_spec_of_several_dofs(tmp_path: Path) -> None:
    recording = loop(tmp_path, apply(shipped_spec("three_mass"), {"noise": NOISE}))
    found = diagnose(recording, draft_of(recording).spec)
    assert found.verdict in ("match", "retuned") and read_spec(found.patched).plant.n == 3


def test_a_patched_spec_has_both_halves_of_its_matrices() -> None:
    """The diagnosis fits one half of them."""
    part = Part(changes={"plant.stiffness[1]": -9.0, "plant.mass[0]": 1.3})
    plant = patched_spec([part], shipped_spec("three_mass")).plant
    assert plant.stiffness[1] == plant.stiffness[3] == -9.0 and plant.mass[0] == 1.3


def test_what_is_not_recorded_is_a_placeholder_and_told(tmp_path: Path) -> None:
    whole = loop(tmp_path, shipped_spec("paper"), 4.0)
    draft = draft_of(replace(whole, links={}))
    assert {"The uses of link tau2 are not recorded: its delay is taken as 0."} < set(draft.told)
    assert any("interface and numerical are placeholders" in sentence for sentence in draft.told)
    assert draft_of(replace(whole, links={"tau4": whole.links["tau4"]})).spec.k_tot == pytest.approx(
        [40.0], rel=0.01
    )
    assert "Placeholder:" in draft.text("bag") and draft.spec.is_loop
    only = plain()
    table = replace(only.plant, position=np.full_like(only.plant.position, np.nan))
    draft = draft_of(replace(only, tables={"plant/state": table}))
    assert "Mass, damping and stiffness of the plant cannot be found" in draft.told[0]
    assert "Placeholder:" in draft.text("bag")
    assert parameters(draft.spec)


@pytest.mark.parametrize("what", ["noise", "no load", "another load", "no force", "one swing"])
def test_no_number_is_made_up(what: str, tmp_path: Path) -> None:
    """Where the recording does not tell the plant, its numbers are placeholders."""
    rng, recording = np.random.default_rng(0), plain()
    table = recording.plant
    if what == "noise":
        table = replace(table, position=1e-4 * rng.normal(size=table.position.shape))
    elif what == "no load":
        table = replace(plain(duration=4.0).plant, effort=np.full((801, 1), np.nan))
    elif what == "another load":
        table = replace(table, effort=rng.normal(size=table.effort.shape))
    elif what == "one swing":
        table = table.rows(slice(0, 200))
    else:
        recording = loop(tmp_path, shipped_spec("paper"), 4.0)
        table = replace(recording.plant, effort=np.full_like(recording.plant.effort, np.nan))
    draft = draft_of(replace(recording, tables=recording.tables | {"plant/state": table}))
    assert not draft.figures and "Mass, damping and stiffness of the plant cannot be found" in draft.told[-1]
    assert draft.spec.plant.mass == (1.0,)


def test_names_that_say_nothing_are_refused() -> None:
    one = plain(duration=2.0).plant
    two = replace(
        one,
        names=("x1", "x2", "drive"),
        position=np.hstack([one.position, one.position, np.full_like(one.position, np.nan)]),
        velocity=np.full((len(one), 3), np.nan),
        effort=np.hstack([np.full((len(one), 2), np.nan), one.effort]),
    )
    recording = replace(plain(duration=2.0), tables={"plant/state": two})
    with pytest.raises(InputError, match="drive of plant/state must be forces on one of x1, x2"):
        draft_of(recording)
    with pytest.raises(
        InputError, match="--dof is y, but must be one of the names in plant/state, x1, x2, drive"
    ):
        draft_of(recording, ["y"])
    with pytest.raises(
        InputError, match="--dof is drive, of which neither position nor velocity is recorded"
    ):
        draft_of(recording, ["drive"])
    assert draft_of(recording, ["x1"]).spec.plant.dofs == ("x1",)
    with pytest.raises(
        InputError, match="has 50 samples of plant/state, but a first spec needs at least 100"
    ):
        draft_of(replace(recording, tables={"plant/state": two.rows(slice(0, 50))}))
    with pytest.raises(InputError, match="--mass is 1, 2 kg, but must be one number above 0 for each of x1"):
        draft_of(plain(duration=2.0), masses=[1.0, 2.0])
    still = replace(
        one, position=np.full_like(one.position, np.nan), velocity=np.full_like(one.velocity, np.nan)
    )
    with pytest.raises(InputError, match="has no position or velocity"):
        draft_of(replace(recording, tables={"plant/state": still}))


def test_periods_are_as_round_as_clocks_are_good() -> None:
    stamps = np.cumsum(np.r_[0, np.full(1000, 1_200_035)])
    assert period(stamps) == 0.0012
    assert period(np.delete(stamps, [5, 6, 40])) == 0.0012
    assert period(stamps[:1]) == 0.001
    assert simplest(0.0099, 0.01, 0.01) == 0.01


def test_the_numbers_of_a_spec_with_changes_stay_a_spec() -> None:
    spec = draft_of(plain()).spec
    assert apply(spec, {"plant.mass": 1.3}).plant.mass == (1.3,)
