"""With which compensator the recorded commands were computed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.diagnosis.computed.controller import (
    Commands,
    believed_stiffness,
    commands_of,
    fitted_compliance,
)
from rthm_analysis.diagnosis.computed.replayed import Predicted, Used
from rthm_analysis.diagnosis.criteria.computed import (
    COMPENSATOR_COMMANDS_TRIED,
    COMPENSATOR_FEWEST_ROWS,
    COMPENSATOR_LONGEST_HORIZON,
    COMPENSATOR_OUTLIER_MEDIANS,
    RIGHT_COMMAND_RMS_SHARE,
    RIGHT_COMMANDS_SHARE,
)
from rthm_analysis.recording import Recording
from rthm_core.compensators import COMPENSATORS, ENTRY, HORIZON, NAMES, ORDER, Compensator, declared
from rthm_core.spec import apply
from rthm_core.topics import COMMAND

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Law:
    """How the controller got both terms of its commands.

    Attributes
    ----------
    spec : Spec
        With the compensator that was found, or the given one where none was.
    position : (n, m) array
        x1 in each recorded command as it was predicted, m.
    found : bool
        Whether the commands are those of this spec's controller, up to its k_tot.
    """

    spec: Spec
    position: Floats
    found: bool


def law_with(recording: Recording, spec: Spec, used: Used) -> Law:
    """Law with the compensator of the spec, from the samples used."""
    said = used.predicted(spec)
    found = _reproduced(recording, spec, used, said)
    return Law(spec, _at_commands(recording, used, _as_told(recording, spec, used, said)), found)


def _as_told(recording: Recording, spec: Spec, used: Used, said: Predicted) -> Predicted:
    """Terms of commands whose recorded F_d is that of the reference, not the predicted one: what a prediction
    adds to it then counts with x1.
    """
    told = np.where((used.recorded >= 0)[:, None], _efforts(recording, spec, used), np.nan)
    columns = zip(told.T, used.force.T, strict=True)
    if not all(_same(one, reference) for one, reference in columns):
        return said
    added = (said.force - used.force) / believed_stiffness(spec)
    return Predicted(said.position + added, used.force)


def other_law(recording: Recording, spec: Spec, used: Used) -> Law | None:
    """Law with another compensator, order or horizon that reproduces the commands; None: there is none."""
    middle = max(used.time.size // 2 - COMPENSATOR_COMMANDS_TRIED // 2, 0)
    part = used.part(middle, middle + COMPENSATOR_COMMANDS_TRIED)
    for other in _others(recording, spec, part):
        if _reproduced(recording, other, part, part.predicted(other), part.settled):
            law = law_with(recording, other, used)
            if law.found:
                return law
    return None


def changed(spec: Spec, law: Law) -> dict[str, Any]:
    """Entries of the compensator that the law has other than the spec."""
    old, new = spec.loop().actuator, law.spec.loop().actuator
    return {
        f"actuator.{name}": getattr(new, name)
        for name in _kind(law.spec).entries
        if getattr(old, name) != getattr(new, name)
    }


def _others(recording: Recording, spec: Spec, part: Used) -> Iterator[Spec]:
    """Specs with other compensators, the likely ones first."""
    known = recording.spec
    if known is not None and known.actuator is not None and known.actuator.compensator in NAMES:
        yield apply(
            spec, {f"actuator.{name}": getattr(known.actuator, name) for name in (ENTRY, ORDER, HORIZON)}
        )
    horizons = [spec.loop().actuator.compensator_horizon]
    for horizon in [*horizons, *([None] if horizons[0] is not None else [])]:
        yield from _kinds(apply(spec, {"actuator.compensator_horizon": horizon}))
    for one in _kinds(spec):
        if _kind(one).predicts:
            yield from _with_fitted_horizon(recording, one, part)


def _kinds(spec: Spec) -> Iterator[Spec]:
    """Specs with every compensator and order."""
    for one in COMPENSATORS:
        for order in one.orders or (None,):
            ordered = {} if order is None else {f"actuator.{ORDER}": order}
            yield apply(spec, {f"actuator.{ENTRY}": one.name} | ordered)


def _with_fitted_horizon(recording: Recording, spec: Spec, part: Used) -> Iterator[Spec]:
    """The spec with the horizon that fits the recorded force references best.

    A prediction is a polynomial of its horizon, so as many replays as its order has coefficients tell it.
    """
    count = spec.loop().actuator.compensator_order + 1 if _kind(spec).orders else 2
    nodes = np.linspace(0.0, 0.1, count)
    values = [part.predicted(_with_horizon(spec, one)).force for one in nodes.tolist()]
    told = _efforts(recording, spec, part)
    rows = (part.recorded >= 0) & np.isfinite(told).all(axis=1)
    rows &= np.isfinite(np.array(values)).all(axis=(0, 2)) & (np.arange(part.time.size) >= part.settled)
    if np.count_nonzero(rows) < COMPENSATOR_FEWEST_ROWS:
        return
    power = np.vander(nodes, count, increasing=True)
    curves = np.linalg.solve(power, np.array([one[rows].ravel() for one in values]))
    horizon = _best_root(curves, told[rows].ravel())
    if 0.0 <= horizon <= COMPENSATOR_LONGEST_HORIZON:
        yield _with_horizon(spec, round(horizon, 9))


def _best_root(curves: Floats, told: Floats) -> float:
    """Abscissa at which the polynomials with coefficients `curves` (k, n) come nearest to `told` (n,)."""
    order = np.arange(curves.shape[0])

    def typical(h: float) -> float:
        return float(np.median(np.abs(h**order @ curves - told)))

    row = np.linspace(0.0, COMPENSATOR_LONGEST_HORIZON, 401)
    best: float = min(row.tolist(), key=typical)
    for _ in range(30):
        slope = (order[1:] * best ** order[:-1]) @ curves[1:]
        off = told - best**order @ curves
        near = np.abs(off) <= COMPENSATOR_OUTLIER_MEDIANS * np.median(np.abs(off)) + 1e-300
        step = float(slope[near] @ off[near]) / max(float(slope[near] @ slope[near]), 1e-300)
        best += step
        if abs(step) < 1e-13:
            break
    return best


def _kind(spec: Spec) -> Compensator:
    kind = declared(spec.loop().actuator.compensator)
    assert kind is not None  # no controller runs with another
    return kind


def _with_horizon(spec: Spec, horizon: float) -> Spec:
    return apply(spec, {"actuator.compensator_horizon": horizon})


def _efforts(recording: Recording, spec: Spec, used: Used) -> Floats:
    """F_d (n, m) that the recorded commands say they used, N."""
    table = recording.tables[COMMAND]
    return table.columns("effort", spec.loop().actuator.names)[used.recorded]


def _at_commands(recording: Recording, used: Used, said: Predicted) -> Floats:
    """Predicted positions (n, m) of the recorded commands."""
    position = np.full((len(recording.tables[COMMAND]), said.position.shape[1]), np.nan)
    there = used.recorded >= 0
    position[used.recorded[there]] = said.position[there]
    return position


def _reproduced(recording: Recording, spec: Spec, used: Used, said: Predicted, first: int = 0) -> bool:
    """Whether the commands are those predicted, from the command `first` on, with some k_tot."""
    rows = (np.arange(used.time.size) >= first) & (used.recorded >= 0)
    chosen = Used(*(column[rows] for column in used.__dict__.values()))
    some = _as_told(recording, spec, chosen, Predicted(said.position[rows], said.force[rows]))
    position, told = _at_commands(recording, chosen, some), _efforts(recording, spec, chosen)
    compliances = (1.0 / believed_stiffness(spec)).tolist()
    for actuator, compliance in enumerate(compliances):
        commands = commands_of(recording, spec, position, actuator)
        if not commands.time.size or not _same(told[:, actuator], some.force[:, actuator]):
            return False
        if not is_law(commands, compliance):
            return False
    return True


def is_law(commands: Commands, compliance: float) -> bool:
    """Whether most of the commands are ``x1 + F_d / k_tot``, with this ``1 / k_tot`` or another one."""
    if commands.right(commands.error(compliance)) >= RIGHT_COMMANDS_SHARE:
        return True
    fitted = fitted_compliance(commands)[0]
    return fitted > 0.0 and commands.right(commands.error(fitted)) >= RIGHT_COMMANDS_SHARE


def _same(told: Floats, predicted: Floats) -> bool:
    known = np.isfinite(told) & np.isfinite(predicted)
    if not known.any():
        return False
    size = max(float(np.sqrt(np.mean(told[known] ** 2))), 1e-12)
    return (
        float(np.mean(np.abs(told - predicted)[known] <= RIGHT_COMMAND_RMS_SHARE * size))
        >= RIGHT_COMMANDS_SHARE
    )
