"""Whether a spec and a recording are of one rig: the same names, as many of them, and what drives it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.recording import Recording
from rthm_core.errors import InputError
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE, PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.spec import Spec


OF_THE_RIG = ("plant", "numerical", "interface", "actuator", "effects")
"""Sections that describe a rig; loads, timing and noise are those of a test."""


def check_names(recording: Recording, spec: Spec) -> None:
    """Compare the names of every topic with those of the spec.

    Raises
    ------
    InputError
        When a name of the spec is not recorded, a part of the loop has others than the spec, or neither
        commands nor forces are recorded; with both lists and the way out.
    """
    _has(recording.plant.names, spec.plant.dofs, PLANT_STATE)
    if not spec.is_loop:
        return
    loop, known = spec.loop(), {*spec.plant.dofs, *spec.loop().actuator.names}
    beyond = [name for name in recording.plant.names if name not in known]
    if beyond:  # without any other name the motors are only not recorded
        _has(recording.plant.names, loop.actuator.names, PLANT_STATE)
    for topic, names in _of_parts(spec):
        table = recording.tables.get(topic)
        if table is not None:
            _same(table.names, names, topic)
    _check_driven(recording, loop.actuator.names)


def check_one_rig(specs: Sequence[Spec], recordings: Sequence[str]) -> None:
    """Compare the specs of several recordings: what they say of the rig has to be the same.

    Raises
    ------
    InputError
        When a section that describes the rig differs from the first one's, with its name and the way out.
    """
    first, *others = specs
    for spec, recording in zip(others, recordings[1:], strict=True):
        unlike = [name for name in OF_THE_RIG if _anywhere(spec, name) != _anywhere(first, name)]
        if unlike:
            raise InputError(
                f"the specs of {recordings[0]} and {recording} describe two rigs ({', '.join(unlike)}); give "
                "the spec of both with --spec."
            )


def _anywhere(spec: Spec, section: str) -> object:
    """A section of the rig, wherever its masses start."""
    found = getattr(spec, section)
    starts = {name: () for name in ("initial_position", "initial_velocity") if hasattr(found, name)}
    return found.model_copy(update=starts) if starts else found


def _of_parts(spec: Spec) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Topics of the parts that compute, and the names that they have."""
    loop = spec.loop()
    yield NUMERICAL_STATE, loop.numerical.dofs
    yield FORCE_REFERENCE, loop.actuator.names
    yield COMMAND, loop.actuator.names


def _has(recorded: tuple[str, ...], needed: tuple[str, ...], topic: str) -> None:
    missing = [name for name in needed if name not in recorded]
    if missing:
        raise _another_rig(topic, recorded, f"not {', '.join(missing)} of the spec")


def _same(recorded: tuple[str, ...], needed: tuple[str, ...], topic: str) -> None:
    _has(recorded, needed, topic)
    more = [name for name in recorded if name not in needed]
    if more:
        raise _another_rig(topic, recorded, f"the spec has only {', '.join(needed)}")


def _another_rig(topic: str, recorded: tuple[str, ...], but: str) -> InputError:
    there = ", ".join(recorded) or "no names"
    return InputError(f"the recording has {there} in {topic}, but {but}; use the spec of this test.")


def _check_driven(recording: Recording, actuators: tuple[str, ...]) -> None:
    if COMMAND in recording.tables:
        return
    if not np.isfinite(recording.plant.columns("effort", actuators)).any():
        raise InputError(
            f"{recording.path} has neither actuator/command nor forces of {', '.join(actuators)} in "
            "plant/state, so what drove the plant is not known; record actuator/command."
        )
