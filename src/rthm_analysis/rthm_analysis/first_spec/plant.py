"""What a recording says of the plant: its matrices, how well they are known, and where its motion began."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import gather
from rthm_analysis.first_spec.draft import DIGITS, UNTOLD, Draft, rounded, uncertainty_of
from rthm_analysis.first_spec.motion import beginning, plant_of, wire_stiffness, with_steps_between
from rthm_analysis.first_spec.names import Parts
from rthm_analysis.identification import Figure
from rthm_core.spec.sections import MATRICES

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_analysis.first_spec.matrices import Matrices
    from rthm_analysis.recording import Recording

ONE_KG = (
    "No known force drives the motion, so only damping and stiffness over mass can be found: the mass of "
    "{dof} is assumed to be exactly 1 kg; weigh it and give it with --mass."
)


def add_plant(draft: Draft, recording: Recording, parts: Parts, masses: Sequence[float]) -> None:
    """Matrices of the plant, how well they are known, and where its motion began."""
    evidence = gather(recording, draft.spec)
    wires = dict(zip(parts.actuators, draft.parameters.get("interface.plant_dof", ()), strict=False))
    commanded = wires if evidence.driven_by == "command" else {}
    positions, velocities = beginning(evidence, parts.dofs, tuple(commanded))
    draft.parameters |= {"plant.initial_position": positions, "plant.initial_velocity": velocities}
    if commanded:
        _wires(draft, wire_stiffness(evidence, parts.dofs, commanded))
    if commanded and "actuator.motor_poles" not in draft.parameters:
        evidence = with_steps_between(evidence, draft.parameters["actuator.stiffness"])
    matrices, driven = plant_of(evidence, parts.dofs, commanded, masses)
    if matrices is None:
        if masses:
            draft.parameters["plant.mass"] = np.diag(masses).ravel().tolist()
        draft.untold(
            "Mass, damping and stiffness of the plant cannot be found: that needs the positions of all dofs "
            f"({', '.join(parts.dofs)}) and the forces of all actuators over several cycles.",
            *(f"plant.{name}" for name in MATRICES if not (masses and name == "mass")),
        )
        return
    _add_unseen_steps(draft, matrices, evidence, parts.dofs, commanded)
    for name, unit in MATRICES.items():
        _matrix(draft, matrices, name, unit, parts.dofs)
    if masses:
        draft.notes["plant.mass"] = "As weighed (--mass)."
    elif not driven:
        sentence = ONE_KG.format(dof=parts.dofs[0])
        draft.told.append(sentence)
        draft.notes["plant.mass"] = sentence
    if not parts.is_loop and driven:
        draft.notes["load"] = (
            "The known force of the recording is in the bag, and rthm diagnose takes it from there; for a "
            "simulation give it here, as kind file."
        )


def _wires(draft: Draft, found: Sequence[float | None]) -> None:
    """Stiffness of wires that neither the controller nor measured motors told."""
    if draft.notes.get("actuator.stiffness") == UNTOLD and None not in found:
        draft.parameters["actuator.stiffness"] = [rounded(one, DIGITS) for one in found if one is not None]
        draft.notes["actuator.stiffness"] = "From the steps in force at new commands."


def _add_unseen_steps(
    draft: Draft, matrices: Matrices, evidence: Evidence, dofs: Sequence[str], wires: dict[str, str]
) -> None:
    """Add what is not known of the dampings where motors were not measured: whether they jump with their
    commands, or lag, shifts the forces by part of a sample.
    """
    step = float(np.median(np.diff(evidence.time)))
    seen = {channel.place for channel in evidence.channels if channel.family == "motor"}
    for (actuator, dof), stiffness in zip(
        wires.items(), draft.parameters.get("actuator.stiffness", ()), strict=False
    ):
        i, damping = dofs.index(dof), matrices.std["damping"]
        if draft.notes.get("actuator.stiffness") == UNTOLD:
            damping[i, i] = np.hypot(damping[i, i], matrices.value["damping"][i, i])
        elif actuator not in seen:
            damping[i, i] = np.hypot(damping[i, i], stiffness * step / np.sqrt(12.0))


def _matrix(draft: Draft, matrices: Matrices, name: str, unit: str, dofs: Sequence[str]) -> None:
    """One matrix of the plant with its uncertainty."""
    value, std = matrices.value[name].copy(), matrices.std[name]
    for i in range(len(dofs)):
        if name == "damping" and abs(value[i, i]) < std[i, i]:
            value[i, i] = std[i, i]  # a relative uncertainty needs a size
    draft.parameters[f"plant.{name}"] = [rounded(one, DIGITS) for one in value.ravel()]
    sizes, spread = np.abs(np.diag(value)), np.diag(std)
    known = (spread > 0.0) & (sizes > 0.0)
    relative = float((spread[known] / sizes[known]).max(initial=0.0))
    draft.parameters[f"uncertainty.plant.{name}"] = uncertainty_of(relative) if known.any() else 0.0
    found = [
        Figure(f"{name} of {dof}", unit, float(value[i, i]), float(std[i, i]))
        for i, dof in enumerate(dofs)
        if std[i, i] > 0.0
    ]
    draft.figures += found
    if found:
        draft.notes[f"plant.{name}"] = "From the recording: " + "; ".join(one.line for one in found) + "."
