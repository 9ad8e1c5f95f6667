"""The diagnosis of the controller."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from rthm_analysis.diagnosis.computed import words
from rthm_analysis.diagnosis.computed.common import effect_of, unchecked, wrong_kind
from rthm_analysis.diagnosis.computed.compensators import Law, changed, is_law, law_with, other_law
from rthm_analysis.diagnosis.computed.controller import (
    Commands,
    affine,
    believed_stiffness,
    commands_of,
    energy,
    fitted_compliance,
    held_position,
)
from rthm_analysis.diagnosis.computed.latched import Latched, latched
from rthm_analysis.diagnosis.computed.numerical import size_of
from rthm_analysis.diagnosis.computed.replayed import samples_used
from rthm_analysis.diagnosis.criteria.computed import (
    COMPUTED_FEWEST_SAMPLES,
    COMPUTED_FLOOR,
    LIMITED_COMMANDS_SHARE,
    OTHER_LAW_LEFT_SHARE,
    RIGHT_COMMAND_RMS_SHARE,
    RIGHT_COMMANDS_SHARE,
)
from rthm_analysis.diagnosis.result import Fault, Fit, Limit, Mismatch, Part, Physics, Value, wrong_entry
from rthm_analysis.recording import Recording
from rthm_core.clock import NS, to_ns
from rthm_core.schedule import Schedule
from rthm_core.topics import COMMAND

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.computed.replayed import Used
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def diagnose_controller(recording: Recording, spec: Spec, schedule: Schedule) -> Part:
    """Find another k_tot or another compensator than the spec's in the controller."""
    if COMMAND not in recording.tables:
        return unchecked("controller", "actuator/command is not recorded")
    held = latched(recording, spec, schedule, "tau1")
    if held is None:
        return unchecked("controller", "links/tau1 is not recorded and cannot be derived")
    law = _law(recording, spec, held)
    if isinstance(law, str):
        return unchecked("controller", law)
    notes: tuple[str, ...] = ()
    if not held.told:
        notes = (
            "controller: links/tau1 is not recorded: the samples it used are taken from the exact schedule.",
        )
    parts, names = [], spec.loop().actuator.names
    for actuator in range(len(names)):
        commands = commands_of(recording, spec, law.position, actuator)
        if commands.time.size < COMPUTED_FEWEST_SAMPLES:
            return unchecked("controller", "too few commands are recorded with what they were made from")
        parts.append(_one_actuator(recording, law.spec, commands, actuator))
    worst = max((part.blocks[0] for part in parts), key=lambda block: (block.significant, block.mismatch))
    changes = changed(spec, law)
    found = Part.joined(parts)
    unexplained = found.unexplained
    if not law.found and not unexplained:
        unexplained, worst = (words.no_compensator(law.spec),), replace(worst, significant=True)
    return replace(
        found,
        blocks=(_as_specified(recording, spec, held, worst) if changes else worst,),
        changes=changes,
        unexplained=unexplained,
        notes=notes,
        faults=tuple(_fault(spec, law.spec, name) for name in changes),
    )


def _fault(spec: Spec, right: Spec, name: str) -> Fault:
    """Entry of the compensator that is not the spec's."""
    value = getattr(right.loop().actuator, name.removeprefix("actuator."))
    number = float(value) if isinstance(value, int | float) else None
    text = words.wrong_compensator(spec, right, name)
    return wrong_entry("controller", name, text, number)


def _law(recording: Recording, spec: Spec, held: Latched) -> Law | str:
    """How the commands were made from the samples used, or a sentence that says why it is not known."""
    plain = spec.loop().actuator.compensator == "none"
    simple = Law(spec, held_position(recording, held), True)
    if plain and _all_explained(recording, simple):
        return simple
    used = samples_used(recording, spec)
    if isinstance(used, str):
        reason = f"its commands go through the compensator {spec.loop().actuator.compensator}, and {used}"
        return simple if plain else reason
    nominal = simple if plain else law_with(recording, spec, used)
    if nominal.found and not plain:
        return nominal
    return other_law(recording, spec, used) or (simple if plain else nominal)


def _all_explained(recording: Recording, law: Law) -> bool:
    """Whether most commands of all actuators are those of a law, with some k_tot."""
    stiffness = believed_stiffness(law.spec)
    return all(
        is_law(commands_of(recording, law.spec, law.position, i), 1.0 / k) for i, k in enumerate(stiffness)
    )


def _as_specified(recording: Recording, spec: Spec, held: Latched, found: Mismatch) -> Mismatch:
    """Mismatch of a controller whose compensator is not the one of the spec."""
    used = samples_used(recording, spec)
    plain = spec.loop().actuator.compensator == "none" or isinstance(used, str)
    position = (
        held_position(recording, held) if plain else law_with(recording, spec, cast("Used", used)).position
    )
    off = []
    for i, k in enumerate(believed_stiffness(spec)):
        commands = commands_of(recording, spec, position, i)
        off.append(size_of(commands.error(1.0 / k)) / (COMPUTED_FLOOR * commands.size))
    return Mismatch("controller", max([found.mismatch, *off]), True)


def _one_actuator(recording: Recording, spec: Spec, commands: Commands, actuator: int) -> Part:
    """Law of one actuator's commands."""
    k_tot = believed_stiffness(spec)
    compliance, name = 1.0 / k_tot[actuator], spec.loop().actuator.names[actuator]
    off = commands.error(compliance)
    label = "actuator.stiffness" if k_tot.size == 1 else f"actuator.stiffness[{actuator}]"
    weight = max(size_of(commands.force), 1e-12) * compliance / k_tot[actuator]
    limits = {
        f"controller.{wrong_kind('controller')}.{label}": Limit(
            RIGHT_COMMAND_RMS_SHARE * commands.size / weight, "N/m"
        )
    }
    mismatch = size_of(off) / (COMPUTED_FLOOR * commands.size)
    if commands.right(off) >= RIGHT_COMMANDS_SHARE:
        limited = commands.right(off) < 1.0 - LIMITED_COMMANDS_SHARE
        left = (words.unlike(name, 1.0 - commands.right(off), size_of(off)),) if limited else ()
        told, unexplained = (left, ()) if spec.limits is not None else ((), left)
        block = Mismatch("controller", mismatch, bool(unexplained))
        return Part(blocks=(block,), detection_limits=limits, unexplained=unexplained, notes=told)
    block = Mismatch("controller", mismatch, True)
    train_end = to_ns(recording.duration) * 2 // 3
    train, unseen = commands.rows(commands.time < train_end), commands.rows(commands.time >= train_end)
    value, std = fitted_compliance(train)
    if not np.isfinite(value) or value <= 0.0 or unseen.right(unseen.error(value)) < RIGHT_COMMANDS_SHARE:
        plain = spec.loop().actuator.compensator == "none"
        text = _other(train, unseen, name, compliance, off) if plain else words.no_compensator(spec)
        return Part(blocks=(block,), detection_limits=limits, unexplained=(text,))
    fit = _command_fit(unseen, compliance, value, recording.duration)
    share = 1.0 - (fit.nrmse["explained"] / max(fit.nrmse["nominal"], 1e-15)) ** 2
    stiffness = Value(1.0 / value, std / value**2, "N/m")
    text = words.wrong("controller", label, float(k_tot[actuator]), stiffness, share, "")
    work = energy(recording, spec, commands, off, actuator)
    parameters: dict[str, Value | str] = {"name": label, "value": stiffness}
    one = Physics("controller", wrong_kind("controller"), None, parameters, text, work, share)
    return Part(
        blocks=(block,),
        physics=(one,),
        fits=(fit,),
        detection_limits=limits,
        effects=(effect_of("controller", one),),
    )


def _other(train: Commands, unseen: Commands, name: str, compliance: float, off: Floats) -> str:
    """Another law of x1 and F_d, if there is one; else how far off the commands are."""
    gains, left = affine(train)
    basis = np.column_stack([unseen.x1, unseen.force, np.ones(unseen.u_d.size)])
    most = OTHER_LAW_LEFT_SHARE * size_of(off)
    if left < most and size_of(unseen.u_d - basis @ gains) < most:
        return words.other_law(name, (float(gains[0]), float(gains[1]), float(gains[2])), compliance)
    return words.unlike(
        name, float(np.mean(np.abs(off) > RIGHT_COMMAND_RMS_SHARE * train.size)), size_of(off)
    )


def _command_fit(unseen: Commands, nominal: float, found: float, duration: float) -> Fit:
    scale = max(float(np.std(unseen.u_d)), 1e-12)
    by_spec, by_found = (unseen.u_d - unseen.error(one) for one in (nominal, found))
    off = [size_of(unseen.u_d - one) / scale for one in (by_spec, by_found)]
    floor = COMPUTED_FLOOR * size_of(unseen.u_d) / scale
    nrmse = {"nominal": off[0], "retuned": off[0], "explained": off[1], "noise_floor": floor}
    spans = (0.0, 2.0 * duration / 3.0), (2.0 * duration / 3.0, duration)
    pictures = (unseen.u_d, by_spec, by_spec, by_found)
    return Fit("controller", "u_d", None, *spans, nrmse, unseen.time / NS, *pictures)
