"""Put a first spec together from what a recording says, with a word on whatever it does not say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import FEWEST_RECORDED_SAMPLES
from rthm_analysis.first_spec.computed import (
    LEFT_BY_ITS_LAW,
    connections,
    controller_stiffness,
    numerical_matrices,
    ticks_of,
)
from rthm_analysis.first_spec.draft import COMPUTED_DIGITS, Draft, rounded, uncertainty_of
from rthm_analysis.first_spec.names import Parts, parts_of
from rthm_analysis.first_spec.plant import add_plant
from rthm_analysis.first_spec.timing import timing_of
from rthm_analysis.identification import identify, motions_of
from rthm_core.errors import InputError
from rthm_core.spec.first import SPREAD, UNCERTAINTY
from rthm_core.spec.sections import MATRICES
from rthm_core.topics import NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_analysis.first_spec.matrices import Matrices
    from rthm_analysis.recording import Recording

ZERO_ENTRY = 1e-6
"""Entry of a matrix that was computed with, over its largest one, that is zero."""


def draft_of(recording: Recording, dofs: Sequence[str] = (), masses: Sequence[float] = ()) -> Draft:
    """Draft a spec from a recording of a plant alone, or of a hybrid test.

    Parameters
    ----------
    recording : Recording
    dofs : sequence of str
        Which names of the plant are dofs; none: told by what was recorded.
    masses : sequence of float
        Masses that were weighed, one for each dof, kg; none: to be found.

    Raises
    ------
    InputError
        If the names do not tell what is what, or there is not a mass for each dof.
    """
    if len(recording.plant) < FEWEST_RECORDED_SAMPLES:
        raise InputError(
            f"{recording.path} has {len(recording.plant)} samples of plant/state, but a first spec needs at "
            f"least {FEWEST_RECORDED_SAMPLES}; record longer, or sample faster."
        )
    parts = parts_of(recording, dofs)
    if masses and (len(masses) != len(parts.dofs) or not all(0.0 < mass < np.inf for mass in masses)):
        raise InputError(
            f"--mass is {', '.join(f'{mass:g}' for mass in masses)} kg, but must be one number above 0 for "
            f"each of {', '.join(parts.dofs)}; give {len(parts.dofs)}."
        )
    draft = Draft()
    _placeholders(draft, parts)
    timing, missing = timing_of(recording, is_loop=parts.is_loop)
    draft.parameters |= {f"timing.{name}": value for name, value in timing.items()}
    draft.told += missing
    if parts.is_loop:
        _computed(draft, recording, parts)
        _controller(draft, recording, parts)
        _actuators(draft, recording)
    else:
        draft.notes["timing"] = "For a plant alone only td1 matters."
    add_plant(draft, recording, parts, masses)
    return draft


def _placeholders(draft: Draft, parts: Parts) -> None:
    """Names, and numbers that the schema allows."""
    for side, dofs in (("plant", parts.dofs), ("numerical", parts.numerical)):
        if dofs:
            n = len(dofs)
            draft.parameters |= {
                f"{side}.dofs": list(dofs),
                f"{side}.mass": np.eye(n).ravel().tolist(),
                f"{side}.damping": [0.0] * n**2,
                f"{side}.stiffness": [0.0] * n**2,
                f"{side}.initial_position": [0.0] * n,
                f"{side}.initial_velocity": [0.0] * n,
            }
    if parts.is_loop:
        m = len(parts.actuators)
        draft.parameters |= {
            "interface.plant_dof": [parts.dofs[min(k, len(parts.dofs) - 1)] for k in range(m)],
            "interface.numerical_dof": [parts.numerical[min(k, len(parts.numerical) - 1)] for k in range(m)],
            "interface.stiffness": [0.0] * m,
            "interface.damping": [0.0] * m,
            "actuator.names": list(parts.actuators),
            "actuator.stiffness": [1.0] * m,
            "uncertainty.actuator.stiffness": SPREAD["stiffness"],
        }
    draft.parameters |= {f"uncertainty.plant.{name}": size for name, size in SPREAD.items()}
    draft.notes["uncertainty"] = UNCERTAINTY


def _computed(draft: Draft, recording: Recording, parts: Parts) -> None:
    """Interface and numerical substructure."""
    own = recording.tables[NUMERICAL_STATE]
    draft.parameters["numerical.initial_position"] = np.nan_to_num(own.position[0]).tolist()
    draft.parameters["numerical.initial_velocity"] = np.nan_to_num(own.velocity[0]).tolist()
    numbers = [f"numerical.{name}" for name in MATRICES]
    ticks = ticks_of(recording, parts.dofs, parts.actuators)
    found = connections(ticks, parts.dofs, parts.numerical, parts.actuators) if ticks else []
    if ticks is None or not all(one.left < LEFT_BY_ITS_LAW for one in found):
        draft.untold(
            "Which force references follow from which motion is not recorded, so interface and numerical are "
            "placeholders.",
            "interface.stiffness",
            "interface.damping",
            *numbers,
        )
        return
    draft.parameters["interface.plant_dof"] = [one.plant_dof for one in found]
    draft.parameters["interface.numerical_dof"] = [one.numerical_dof for one in found]
    draft.parameters["interface.stiffness"] = [rounded(one.stiffness, COMPUTED_DIGITS) for one in found]
    draft.parameters["interface.damping"] = [rounded(one.damping, COMPUTED_DIGITS) for one in found]
    if np.any(ticks.load):
        draft.told.append("A load acts on the numerical substructure; describe it in load.numerical.")
        draft.notes["load"] = "A load was recorded in numerical/state; describe it under numerical."
    matrices = numerical_matrices(ticks, [parts.numerical.index(one.numerical_dof) for one in found])
    if matrices is None or not (np.diag(matrices.value["mass"]) > 0.0).all():
        draft.untold(
            "The numerical substructure does not move as a linear one, so its matrices are placeholders.",
            *numbers,
        )
    else:
        draft.parameters |= {f"numerical.{name}": _exact(matrices, name) for name in MATRICES}


def _controller(draft: Draft, recording: Recording, parts: Parts) -> None:
    """The stiffness that the controller computes with."""
    stiffness = controller_stiffness(recording, parts.actuators, draft.parameters["interface.plant_dof"])
    for k, (name, value) in enumerate(zip(parts.actuators, stiffness, strict=True)):
        if value is None:
            draft.untold(
                f"The recorded commands of {name} do not follow from a controller without a compensator: "
                "enter the compensator and k_tot.",
                "actuator.stiffness",
                "actuator.compensator",
            )
        else:
            draft.parameters["actuator.stiffness"][k] = rounded(value, COMPUTED_DIGITS)


def _exact(matrices: Matrices, name: str) -> list[float]:
    """A matrix that was computed with, without what rounding left of zeros."""
    size = {key: float(np.abs(values).max()) for key, values in matrices.value.items()}
    largest = max(size[name], np.sqrt(size["mass"] * size["stiffness"]) if name == "damping" else 0.0)
    values = matrices.value[name].ravel()
    return [rounded(one, COMPUTED_DIGITS) if abs(one) > ZERO_ENTRY * largest else 0.0 for one in values]


def _actuators(draft: Draft, recording: Recording) -> None:
    """Motors and wires, as far as they were measured."""
    spec = draft.spec
    motions = motions_of(recording, spec)
    blind = [one.actuator for one in motions if not np.isfinite(one.motor).any()]
    if blind:
        draft.told.append(
            f"The motor position of {', '.join(blind)} is not recorded, so its lag behind the commands "
            "(actuator.motor_poles) is unknown."
        )
    found = identify(motions, spec)
    poles, measured = (found.changes.get(f"actuator.{name}") for name in ("motor_poles", "stiffness"))
    draft.told += found.wrong
    if poles:
        draft.parameters["actuator.motor_poles"] = poles
    if measured is None:
        return
    believed, known = np.array(spec.k_tot), "actuator.stiffness" not in draft.notes
    spread = float(found.changes["uncertainty.actuator.stiffness"])
    if known:
        spread = max(spread, float(np.abs(np.array(measured) / believed - 1.0).max()))
        draft.notes["actuator.stiffness"] = (
            f"Value used by the controller; measured: {', '.join(f'{one:.6g}' for one in measured)} N/m."
        )
    else:
        draft.parameters["actuator.stiffness"] = measured
        draft.notes["actuator.stiffness"] = "As measured."
    draft.parameters["uncertainty.actuator.stiffness"] = uncertainty_of(spread)
