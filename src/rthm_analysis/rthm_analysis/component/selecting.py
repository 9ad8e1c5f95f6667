"""Which parts the force of a component has: as few as predict it, found one after the other."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rthm_analysis.component.criteria import (
    AT_NOISE_RATIO,
    BIC_OF_CHANCE,
    GUESSES_REFINED,
    LAGS_TRIED,
    LEAST_GAIN_SHARE,
    LONGEST_LAG_SHARE,
    MOST_LAWS,
    MOST_POWER,
    NEGATIVE_SHARE,
    PLAINER_LOSS_SHARE,
)
from rthm_analysis.component.fitting import Fitted, Model, Part, fitted, sized, with_steps
from rthm_analysis.component.shapes import ALWAYS, Power, Shape, base_shapes, law_shapes

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Selection:
    """What was chosen, and spring, damper and offset alone to compare it with."""

    best: Fitted
    plain: Fitted


def selected(parts: Sequence[Part], noise: float, progress: Progress = lambda said: None) -> Selection:
    """The parts of a component's force.

    Parameters
    ----------
    parts : sequence of Part
        Tests, with the samples that may be fitted.
    noise : float
        Standard deviation of the noise of the force, N.
    progress : callable
        Told what is being done.
    """
    inputs = tuple(parts[0].test.inputs)
    powers = (ALWAYS, *(Power(name) for name in inputs))
    plain = sized(Model(tuple(base_shapes((ALWAYS,)))), parts)
    progress("fitting spring and damper")
    best = _with_lags(sized(Model(tuple(base_shapes(powers)), dict.fromkeys(inputs, 0.0)), parts))
    for _ in range(MOST_LAWS):
        if _is_at(noise, best):
            break
        progress("looking for laws that the force follows")
        more = _with_a_law(best, powers, noise)
        if more is None:
            break
        best = _with_lags(with_steps(more, parts[0].test))
    progress("leaving out what is not needed")
    best = _needed(best)
    return Selection(_needed(_with_higher_powers(best)) if inputs else best, plain)


def _is_at(noise: float, one: Fitted) -> bool:
    return one.squares <= AT_NOISE_RATIO * one.left.size * noise**2


def _with_lags(one: Fitted) -> Fitted:
    """The same with the lag of each input that fits best, and all values fitted with them."""
    test = one.parts[0].test
    grid = np.geomspace(0.5 * test.step, LONGEST_LAG_SHARE * float(test.t[-1]), LAGS_TRIED)
    for name in one.model.inputs:
        there = [one.model.lags[name]] if one.model.lags[name] > 0.0 else []
        tried = [
            sized(replace(one.model, lags={**one.model.lags, name: float(lag)}, held=held), one.parts)
            for lag in (0.0, *there, *grid)
            for held in (one.model.held - {name}, one.model.held | {name})
        ]
        one = min(tried, key=lambda found: found.squares)
    return fitted(one.model, one.parts)


def _with_a_law(one: Fitted, powers: tuple[Power, ...], noise: float) -> Fitted | None:
    """The same with the law that explains most of what is left; None where none is worth it."""
    floor = one.left.size * noise**2
    tried = list(_refined(one, powers))
    best = max(tried, key=lambda found: found.gain(one), default=None)
    if best is None or best.gain(one) < BIC_OF_CHANCE:
        return None
    if one.squares - best.squares < LEAST_GAIN_SHARE * (one.squares - floor):
        return None
    law = best.model.shapes[-1].law
    standing_for = {plainer.kind for plainer in law.plainer} if law else set()
    enough = (1.0 + PLAINER_LOSS_SHARE) * best.squares
    plainer = [
        found for found in tried if found.model.shapes[-1].kind in standing_for and found.squares <= enough
    ]
    return min(plainer, key=lambda found: found.squares, default=best)


def _refined(one: Fitted, powers: tuple[Power, ...]) -> Iterator[Fitted]:
    """Models with one law more, from the best beginnings of each kind that is not there yet."""
    test = one.parts[0].test
    present = {shape.kind for shape in one.model.shapes}
    starts = defaultdict(list)
    for shape in law_shapes(test, powers):
        if shape.kind not in present:
            stepped = shape.stepped(test)
            starts[shape.kind].append(
                sized(replace(one.model, shapes=(*one.model.shapes, stepped)), one.parts)
            )
    for tried in starts.values():
        for start in sorted(tried, key=lambda found: found.squares)[:GUESSES_REFINED]:
            found = fitted(start.model, one.parts)
            if _is_possible(found, len(found.model.shapes) - 1):
                yield found


def _is_possible(found: Fitted, i: int) -> bool:
    """Whether a part that takes energy out does so whatever the inputs are."""
    shape = found.model.shapes[i]
    if shape.guess is None or shape.guess.signed:
        return True
    own = [k for k, (at, _) in enumerate(found.model.places) if at == i]
    for part in found.parts:
        size = sum(found.sizes[k] * found.model.scale(part.test, found.model.places[k][1]) for k in own)
        low, high = float(np.min(size)), float(np.max(np.abs(size)))
        if low < -NEGATIVE_SHARE * high:
            return False
    return True


def _needed(one: Fitted) -> Fitted:
    """The same without the sizes and lags without which it predicts as well, or better by chance alone."""
    while True:
        tried = [sized(model, one.parts) for model in _simpler(one.model)]
        best = max(tried, key=lambda found: found.gain(one), default=None)
        if best is None or best.gain(one) <= -BIC_OF_CHANCE:
            return fitted(one.model, one.parts)
        one = best


def _simpler(model: Model) -> Iterator[Model]:
    """Models with one size, or one lag, less."""
    for i, shape in enumerate(model.shapes):
        for power in shape.powers:
            left = tuple(other for other in shape.powers if other != power)
            kept = (replace(shape, powers=left),) if left else ()
            if kept or len(model.shapes) > 1:
                yield replace(model, shapes=(*model.shapes[:i], *kept, *model.shapes[i + 1 :]))
    for name in model.inputs:
        if model.lags[name] > 0.0:
            yield replace(model, lags={**model.lags, name: 0.0})


def _with_higher_powers(one: Fitted) -> Fitted:
    """The same with squares of inputs where these scale a part better than a straight line."""
    for i, shape in enumerate(one.model.shapes):
        for name in dict.fromkeys(power.of for power in shape.powers if power.of):
            more: Shape = replace(shape, powers=(*one.model.shapes[i].powers, Power(name, MOST_POWER)))
            shapes = (*one.model.shapes[:i], more, *one.model.shapes[i + 1 :])
            found = fitted(replace(one.model, shapes=shapes), one.parts)
            if found.gain(one) > BIC_OF_CHANCE and _is_possible(found, i):
                one = found
    return one
