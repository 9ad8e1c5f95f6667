"""The diagnosis of the blocks that compute."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.computed import words
from rthm_analysis.diagnosis.computed.common import effect_of, unchecked, wrong_kind
from rthm_analysis.diagnosis.computed.control import diagnose_controller
from rthm_analysis.diagnosis.computed.latched import delayed, latched
from rthm_analysis.diagnosis.computed.numerical import (
    Search,
    Ticks,
    errors,
    load_uncertainty,
    replay,
    scales,
    search,
    size_of,
    ticks_of,
)
from rthm_analysis.diagnosis.computed.structure import Structure, structure
from rthm_analysis.diagnosis.criteria.computed import (
    COMPUTED_FEWEST_SAMPLES,
    COMPUTED_FLOOR,
    NUMERICAL_STILL_LEFT_SHARE,
    SIGNIFICANT_TO_ROUNDING,
    STATE_ROUNDING,
)
from rthm_analysis.diagnosis.result import Alternative, Fit, Limit, Mismatch, Part, Physics, Value
from rthm_analysis.recording import Recording
from rthm_core.clock import NS, to_ns
from rthm_core.schedule import Schedule
from rthm_core.topics import FORCE_REFERENCE, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def diagnose_computed(recording: Recording, spec: Spec) -> Part:
    """Find parameters that the controller or the numerical substructure has wrong.

    Parameters
    ----------
    recording : Recording
    spec : Spec
        What the test was to be; of a plant alone nothing is said.

    Returns
    -------
    Part
        Blocks ``numerical`` and ``controller``.
    """
    if not spec.is_loop:
        return Part()
    schedule = Schedule(spec)
    return Part.joined(
        [_numerical(recording, spec, schedule), diagnose_controller(recording, spec, schedule)]
    )


def _numerical(recording: Recording, spec: Spec, schedule: Schedule) -> Part:
    if NUMERICAL_STATE not in recording.tables:
        return unchecked("numerical", "numerical/state is not recorded")
    held = latched(recording, spec, schedule, "tau2")
    if held is None:
        return unchecked("numerical", "links/tau2 is not recorded and cannot be derived")
    ticks = ticks_of(recording, spec, held)
    end = to_ns(recording.duration) + 1
    train, judge, unseen = (ticks.part(end * i // 3, end * (i + 1) // 3) for i in range(3))
    if min(train.steps.size, judge.steps.size, unseen.steps.size) < COMPUTED_FEWEST_SAMPLES:
        return unchecked("numerical", "too few of its ticks are recorded with what it used")
    nominal, seen = structure(spec), ticks.part(0, end * 2 // 3)
    enough = _enough(seen, nominal)
    found = search(train, judge, nominal, scales(seen), enough)
    notes = _numerical_notes(recording, held.told)
    return _numerical_part(recording, spec, ticks, unseen, nominal, found, enough, notes)


def _numerical_notes(recording: Recording, told: bool) -> tuple[str, ...]:
    notes = []
    if not told:
        notes.append(
            "numerical: links/tau2 is not recorded: the samples it used are taken from the exact schedule."
        )
    if FORCE_REFERENCE not in recording.tables:
        notes.append("numerical: numerical/force_reference is not recorded: only its motion was checked.")
    return tuple(notes)


def _enough(seen: Ticks, nominal: Structure) -> float:
    """Error of a step that the unknown load between two ticks makes, over the size of the step."""
    dt, n = seen.period / NS, nominal.mass.shape[0]
    kick = float(np.abs(np.linalg.inv(nominal.mass)).max()) * load_uncertainty(seen) * dt
    return STATE_ROUNDING + 3.0 * kick / float(scales(seen).change[n:].min())


def _numerical_part(
    recording: Recording,
    spec: Spec,
    ticks: Ticks,
    unseen: Ticks,
    nominal: Structure,
    found: Search,
    enough: float,
    notes: tuple[str, ...],
) -> Part:
    by_spec = replay(ticks, nominal)
    known = np.isfinite(ticks.force) & np.isfinite(by_spec)
    off = np.where(known, ticks.force - by_spec, 0.0)
    size = max(float(np.sqrt(np.mean(ticks.force[known] ** 2))) if known.any() else 0.0, 1e-12)
    mismatch = float(np.sqrt(np.mean(off[known] ** 2))) / (COMPUTED_FLOOR * size) if known.any() else 0.0
    limits = _numerical_limits(unseen, nominal, enough)
    blocks = (
        Mismatch("numerical", mismatch, bool(found.names) or found.left > SIGNIFICANT_TO_ROUNDING * enough),
    )
    if not found.names:
        left = (
            (words.not_one("numerical", COMPUTED_FLOOR * mismatch, COMPUTED_FLOOR * mismatch),)
            if blocks[0].significant
            else ()
        )
        return Part(blocks=blocks, detection_limits=limits, unexplained=left, notes=notes)
    fit = _numerical_fit(unseen, nominal, found, recording.duration)
    share = 1.0 - (fit.nrmse["explained"] / max(fit.nrmse["nominal"], 1e-15)) ** 2
    work = _term_energy(recording, spec, ticks, found, nominal)
    physics = tuple(
        _wrong(nominal, found, i, share, work / len(found.names)) for i in range(len(found.names))
    )
    others = tuple(
        Alternative("numerical", wrong_kind("numerical"), fit.nrmse["nominal"] * error / found.nominal, True)
        for name, error in sorted(found.tried.items(), key=lambda item: item[1])[1:3]
    )
    still = found.left > max(SIGNIFICANT_TO_ROUNDING * enough, NUMERICAL_STILL_LEFT_SHARE * found.nominal)
    left = (
        words.not_one(
            "numerical", COMPUTED_FLOOR * mismatch, COMPUTED_FLOOR * mismatch * found.left / found.nominal
        ),
    )
    return Part(
        blocks=blocks,
        physics=physics,
        alternatives=others,
        fits=(fit,),
        detection_limits=limits,
        effects=tuple(effect_of("numerical", one) for one in physics),
        unexplained=left if still else (),
        notes=notes,
    )


def _wrong(nominal: Structure, found: Search, i: int, share: float, work: float) -> Physics:
    name = found.names[i]
    value = Value(found.structure.value(name), float(found.std[i]), nominal.unit(name))
    others = sorted((error, other) for other, error in found.tried.items() if other not in found.names)
    after = ""
    if others and len(found.names) == 1:
        after = words.second_best(nominal.spec_name(others[0][1]), others[0][0] / max(found.left, 1e-15))
    label = nominal.spec_name(name)
    text = words.wrong("numerical", label, nominal.value(name), value, share, after)
    return Physics(
        "numerical", wrong_kind("numerical"), None, {"name": label, "value": value}, text, work, share
    )


def _numerical_fit(unseen: Ticks, nominal: Structure, found: Search, duration: float) -> Fit:
    """F_d on the last third, in a free run from the recorded state at its beginning."""
    by_spec, by_found = replay(unseen, nominal), replay(unseen, found.structure)
    known = (np.isfinite(unseen.force) & np.isfinite(by_spec)).all(axis=1)
    recorded = unseen.force[known, 0]
    scale = max(float(np.std(recorded)) if recorded.size else 0.0, 1e-12)
    floor = COMPUTED_FLOOR * float(np.sqrt(np.mean(recorded**2))) / scale if recorded.size else COMPUTED_FLOOR
    off = [size_of(recorded - one[known, 0]) / scale for one in (by_spec, by_found)]
    nrmse = {"nominal": off[0], "retuned": off[0], "explained": off[1], "noise_floor": floor}
    spans = (0.0, 2.0 * duration / 3.0), (2.0 * duration / 3.0, duration)
    pictures = (recorded, by_spec[known, 0], by_spec[known, 0], by_found[known, 0])
    return Fit("numerical", "F_d", None, *spans, nrmse, unseen.time[known] / NS, *pictures)


def _numerical_limits(unseen: Ticks, nominal: Structure, enough: float) -> dict[str, Limit]:
    """Smallest error of every parameter that would have been seen."""
    sizes = scales(unseen)
    error = errors(unseen, nominal, sizes)
    limits = {}
    for name in nominal.names:
        reach = 1e-4 * max(abs(nominal.value(name)), 1e-3)
        moved = errors(unseen, nominal.changed(name, nominal.value(name) + reach), sizes)
        change = size_of(moved - error) / reach
        label = f"numerical.{wrong_kind('numerical')}.{nominal.spec_name(name)}"
        limits[label] = Limit(enough / max(change, 1e-15), nominal.unit(name))
    return limits


def _term_energy(recording: Recording, spec: Spec, ticks: Ticks, found: Search, nominal: Structure) -> float:
    """Work, J, of the forces that the wrong values make with the recorded motion; + introduced.

    Of a substructure's own parameter on its masses; of the interface's on both substructures, on the plant
    when the force reference is at the motor.
    """
    wrong, timing, plant = found.structure, spec.loop().timing, recording.plant
    n = nominal.mass.shape[0]
    x2, v2 = ticks.z2[:, :n], ticks.z2[:, n:]
    a2 = np.gradient(v2, ticks.time / NS, axis=0)
    terms: tuple[tuple[Floats, Floats], ...]
    terms = ((wrong.mass - nominal.mass, a2), (wrong.damping - nominal.damping, v2))
    terms = (*terms, (wrong.stiffness - nominal.stiffness, x2))
    own = -sum(np.einsum("ij,nj,ni->n", change, motion, v2) for change, motion in terms)
    more = wrong.force(ticks.held, ticks.z2) - nominal.force(ticks.held, ticks.z2)
    own = own - np.sum(more * v2[:, nominal.dof], axis=1)
    at = plant.stamp_ns - recording.start_ns
    force = delayed(ticks.time, np.nan_to_num(more), timing.ns("tau3") + timing.ns("tau4"), at)
    v1 = plant.columns("velocity", spec.loop().interface.plant_dof)
    work = np.nansum(own[:-1] * np.diff(ticks.time)) + np.sum(np.sum(force * v1, axis=1)[:-1] * np.diff(at))
    return float(work) / NS
