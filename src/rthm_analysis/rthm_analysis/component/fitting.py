"""The best values of a model of a component: those that shape its forces step by step, all sizes at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.component.criteria import EVALUATIONS_EACH, FIT_DIFFERENCE
from rthm_analysis.component.recorded import ComponentTest
from rthm_analysis.component.shapes import ALWAYS, Power, Shape, seen_in

if TYPE_CHECKING:
    from rthm_core.compiled import Flags, Floats
    from rthm_core.effects.possible import Seen


class Part(NamedTuple):
    """A test and the samples of it that count."""

    test: ComponentTest
    rows: Flags


@dataclass(frozen=True)
class Model:
    """Parts of the force, the lag, s, of each input that scales them, and inputs that keep the value of a
    sample until the next; others go on a straight line.
    """

    shapes: tuple[Shape, ...]
    lags: Mapping[str, float] = field(default_factory=dict)
    held: frozenset[str] = frozenset()

    @property
    def places(self) -> list[tuple[int, Power]]:
        """What each size belongs to: a part and a power of an input."""
        return [(i, power) for i, shape in enumerate(self.shapes) for power in shape.powers]

    @property
    def inputs(self) -> list[str]:
        """Inputs that scale something, in the order of their lags."""
        return [name for name in self.lags if any(power.of == name for _, power in self.places)]

    def columns(self, test: ComponentTest) -> Floats:
        """Forces (s, q) of which each has one size."""
        scales = {power: self.scale(test, power) for power in dict.fromkeys(of for _, of in self.places)}
        signals = [shape.signal(test) for shape in self.shapes]
        return np.stack([signals[i] * scales[power] for i, power in self.places], axis=1)

    def scale(self, test: ComponentTest, power: Power) -> Floats:
        """What a size is proportional to, (s,)."""
        if power == ALWAYS:
            return np.ones_like(test.t)
        values, lag = test.inputs[power.of], self.lags[power.of]
        return lagged(values, lag, test.step, held=power.of in self.held) ** power.power


def lagged(values: Floats, lag: float, step: float, *, held: bool = False) -> Floats:
    """An input (s,) behind a first-order lag, s; it has been constant before the first sample.

    Between samples it is `held`, or goes on a straight line.
    """
    from scipy.signal import lfilter

    if lag <= 0.0:
        return values
    kept = np.exp(-step / lag)
    between = values[:-1] if held else 0.5 * (values[1:] + values[:-1])
    middle = np.append(values[:1], between)
    return np.asarray(lfilter([1.0 - kept], [1.0, -kept], middle, zi=[kept * values[0]])[0])


@dataclass(frozen=True)
class Fitted:
    """A model at its best on some parts.

    Attributes
    ----------
    model : Model
    sizes : (q,) array
        Of its columns.
    left : (n,) array
        What it leaves of the force at the samples that count, N.
    parts : sequence of Part
    """

    model: Model
    sizes: Floats
    left: Floats
    parts: Sequence[Part]

    @property
    def squares(self) -> float:
        """Squared error, N^2."""
        return float(self.left @ self.left)

    @property
    def count(self) -> int:
        """Numbers that were fitted."""
        return self.sizes.size + len(coordinates(self.model, self.parts[0].test))

    @cached_property
    def colour(self) -> float:
        """Samples that say as much as one whose error is independent of the others."""
        left = self.left - self.left.mean()
        power = np.abs(np.fft.rfft(left, 2 * left.size)) ** 2
        alike = np.fft.irfft(power)[: left.size]
        alike = alike / max(float(alike[0]), 1e-300)
        ends = np.flatnonzero(alike < 0.0)
        return float(1.0 + 2.0 * alike[1 : ends[0] if ends.size else left.size].sum())

    def gain(self, other: Fitted) -> float:
        """How much better this is than another, by Bayes' criterion for the samples that are independent."""
        samples = self.left.size / self.colour
        ratio = max(other.squares, 1e-300) / max(self.squares, 1e-300)
        return float(samples * np.log(ratio) - (self.count - other.count) * np.log(max(samples, 2.0)))

    def force(self, test: ComponentTest) -> Floats:
        """Force of the model along a test, (s,) N."""
        return np.asarray(self.model.columns(test) @ self.sizes)


class Coordinate(NamedTuple):
    """A number that is not a size: a parameter of a shape, or the lag of an input."""

    shape: int
    name: str
    positive: bool
    scale: float


def coordinates(model: Model, test: ComponentTest) -> list[Coordinate]:
    """What a fit moves beside sizes."""
    found = []
    for i, shape in enumerate(model.shapes):
        for name in shape.free:
            assert shape.law is not None
            low = getattr(shape.law.parameters[name], "minimum", None)
            possible = shape.law.possible.get(name)
            if possible is not None:
                low = max(possible(shape.values, seen_in(test))[0], -np.inf if low is None else low)
            value = shape.values[name]
            found.append(Coordinate(i, name, low is not None and low >= 0.0 < value, abs(value) or 1.0))
    return found + [Coordinate(-1, name, True, 1.0) for name in model.inputs if model.lags[name] > 0.0]


def moved(model: Model, where: Sequence[Coordinate], values: Floats, seen: Seen) -> Model:
    """The model with other coordinates, each kept to what is possible."""
    shapes, lags = list(model.shapes), dict(model.lags)
    for one, value in zip(where, values.tolist(), strict=True):
        if one.shape < 0:
            lags[one.name] = model.lags[one.name] * float(np.exp(value))
            continue
        shape = shapes[one.shape]
        before = model.shapes[one.shape].values[one.name]
        new = before * float(np.exp(value)) if one.positive else before + value * one.scale
        possible = shape.law.possible.get(one.name) if shape.law else None
        if possible is not None:
            low, high = possible(shape.values, seen)
            new = min(max(new, low), high)
        shapes[one.shape] = shape.at({one.name: new})
    return replace(model, shapes=tuple(shapes), lags=lags)


def sized(model: Model, parts: Sequence[Part]) -> Fitted:
    """The best sizes of a model whose shapes stay as they are."""
    columns = np.concatenate([model.columns(part.test)[part.rows] for part in parts])
    force = np.concatenate([part.test.force[part.rows] for part in parts])
    scale = np.sqrt(np.mean(np.square(columns), axis=0)) + 1e-300
    sizes = np.linalg.lstsq(columns / scale, force, rcond=1e-10)[0] / scale
    return Fitted(model, sizes, force - columns @ sizes, parts)


def fitted(model: Model, parts: Sequence[Part]) -> Fitted:
    """The best values of all that a model leaves open.

    Parameters
    ----------
    model : Model
        Where the fit begins.
    parts : sequence of Part
    """
    from scipy.optimize import least_squares

    where, seen = coordinates(model, parts[0].test), seen_in(parts[0].test)
    if not where:
        return sized(model, parts)

    def left(values: Floats) -> Floats:
        errors = sized(moved(model, where, values, seen), parts).left
        return np.where(np.isfinite(errors), errors, 1e6)

    done = least_squares(
        left,
        np.zeros(len(where)),
        diff_step=FIT_DIFFERENCE,  # type: ignore[arg-type]
        x_scale=0.3,
        max_nfev=EVALUATIONS_EACH,
        bounds=(-6.0, 6.0),
    )
    return sized(moved(model, where, done.x, seen), parts)


def with_steps(found: Fitted, test: ComponentTest) -> Fitted:
    """The same in steps that are short enough for the values that were found."""
    shapes = tuple(shape.stepped(test) for shape in found.model.shapes)
    return sized(replace(found.model, shapes=shapes), found.parts)
