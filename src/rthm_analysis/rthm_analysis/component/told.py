"""Values of a fitted model of a component, with standard deviations, by part and parameter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.component.criteria import FIT_DIFFERENCE
from rthm_analysis.component.fitting import Coordinate, Fitted, Model, coordinates, moved
from rthm_analysis.component.result import Term
from rthm_analysis.component.shapes import ALWAYS, UNITS, Power, Shape, seen_in
from rthm_analysis.diagnosis.result import Value

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

GROUND = "plant"
"""Block whose laws a component follows."""


class Entry(NamedTuple):
    """A number that is told: of which part, for which power of which input, and which parameter."""

    shape: int
    power: Power
    name: str


def told(found: Fitted) -> tuple[tuple[Term, ...], dict[str, Value]]:
    """Parts of the force with their values, and the lag, s, of each input that it depends on."""
    where = coordinates(found.model, found.parts[0].test)
    covariance = _covariance(found, where)
    return _terms(found, where, covariance), _lags(found, where, covariance)


def _terms(found: Fitted, where: Sequence[Coordinate], covariance: Floats) -> tuple[Term, ...]:
    entries = _entries(found.model)
    values = _values(found.model, found.sizes, entries)
    stds = _stds(found, entries, where, covariance)
    terms = []
    for i, shape in enumerate(found.model.shapes):
        said: dict[Power, dict[str, Value]] = {ALWAYS: {}}
        for entry, value, std in zip(entries, values, stds, strict=True):
            if entry.shape == i:
                of = Value(float(value), float(std), _unit(shape, entry.name))
                said.setdefault(entry.power, {})[entry.name] = of
        by_input = {_name(power): own for power, own in said.items() if power != ALWAYS}
        memory = bool(shape.law and shape.law.states)
        terms.append(Term(shape.kind, shape.called, said[ALWAYS], by_input, memory))
    return tuple(terms)


def _lags(found: Fitted, where: Sequence[Coordinate], covariance: Floats) -> dict[str, Value]:
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    stds = {one.name: float(std) for one, std in zip(where, spread, strict=False) if one.shape < 0}
    lags = found.model.lags
    return {name: Value(lags[name], lags[name] * stds.get(name, 0.0), "s") for name in found.model.inputs}


def _name(power: Power) -> str:
    return power.of if power.power == 1 else f"{power.of}^{power.power}"


def _unit(shape: Shape, name: str) -> str:
    return shape.law.unit(name, GROUND) if shape.law else UNITS[shape.kind]


def _entries(model: Model) -> list[Entry]:
    """What is told of each part: sizes for each power, what shapes it once."""
    found = []
    for i, shape in enumerate(model.shapes):
        linear = shape.guess.linear if shape.guess else (shape.kind,)
        found += [Entry(i, power, name) for power in shape.powers for name in linear]
        found += [Entry(i, ALWAYS, name) for name in shape.free if name not in linear]
    return found


def _values(model: Model, sizes: Floats, entries: Sequence[Entry]) -> Floats:
    """Values of the entries: a parameter in which a part is linear is its scale times the size."""
    size = dict(zip(model.places, sizes.tolist(), strict=True))
    values = []
    for i, power, name in entries:
        shape = model.shapes[i]
        linear = shape.guess is None or name in shape.guess.linear
        values.append(shape.values.get(name, 1.0) * (size[i, power] if linear else 1.0))
    return np.array(values)


def _stds(found: Fitted, entries: Sequence[Entry], where: Sequence[Coordinate], covariance: Floats) -> Floats:
    """Standard deviations of the entries, from those of coordinates and sizes."""
    slopes = []
    seen = seen_in(found.parts[0].test)
    here = _values(found.model, found.sizes, entries)
    for k in range(len(where)):
        step = np.zeros(len(where))
        step[k] = FIT_DIFFERENCE
        model = moved(found.model, where, step, seen)
        slopes.append((_values(model, found.sizes, entries) - here) / FIT_DIFFERENCE)
    for k in range(found.sizes.size):
        sizes = found.sizes.copy()
        step_of_size = FIT_DIFFERENCE * (abs(sizes[k]) or 1.0)
        sizes[k] += step_of_size
        slopes.append((_values(found.model, sizes, entries) - here) / step_of_size)
    jacobian = np.array(slopes).T
    squares = np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


def _covariance(found: Fitted, where: Sequence[Coordinate]) -> Floats:
    """Covariance of coordinates and sizes together, for errors that are alike from sample to sample."""
    seen = seen_in(found.parts[0].test)
    columns = _columns(found, found.model)
    moving = []
    for k in range(len(where)):
        step = np.zeros(len(where))
        step[k] = FIT_DIFFERENCE
        there = _columns(found, moved(found.model, where, step, seen))
        moving.append((there - columns) @ found.sizes / FIT_DIFFERENCE)
    jacobian = np.column_stack([*moving, columns])
    scale = np.sqrt(np.sum(np.square(jacobian), axis=0)) + 1e-300
    inverse = np.linalg.pinv((jacobian / scale).T @ (jacobian / scale)) / np.outer(scale, scale)
    freedom = max(found.left.size - found.count, 1)
    return np.asarray(inverse * found.squares / freedom * found.colour)


def _columns(found: Fitted, model: Model) -> Floats:
    return np.concatenate([model.columns(part.test)[part.rows] for part in found.parts])
