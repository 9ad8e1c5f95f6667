"""Effects of which combinations are made: those that were found, and every plain kind beside them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.candidates import FRICTION, candidates
from rthm_analysis.diagnosis.search.judging import Choice
from rthm_analysis.diagnosis.search.starts import Start
from rthm_core.compiled import Floats
from rthm_core.errors import InputError


@dataclass(frozen=True)
class Piece:
    """An effect that a combination may have: one that is there, or a plain kind that is not.

    Attributes
    ----------
    start : Start
        Of a plain kind that is not there, with the trial's size.
    index : int or None
        Place among the effects that are there.
    columns : (c, s k) array
        Change of the prediction with its parameters; of a plain kind, with its size over the trial's.
    whole : (s k,) array
        What it does now.
    """

    start: Start
    index: int | None
    columns: Floats
    whole: Floats

    @property
    def rubs_at(self) -> str | None:
        """Place where it is dry friction, of which there can only be one."""
        return self.start.added.place if self.start.added.kind in FRICTION else None

    @property
    def stays(self) -> bool:
        """Whether no combination can do without it: it is linear in nothing."""
        return self.index is not None and not self.start.amplitude

    def sized(self, factor: float) -> Piece:
        """A plain kind that is not there, with a factor on its size."""
        if self.index is not None:
            return self
        return Piece(self.start.sized(factor), None, self.columns, factor * self.columns[0])


def pieces_of(fitting: Fitting, choice: Choice, columns: Floats) -> list[Piece]:
    """What combinations are made of.

    Parameters
    ----------
    fitting : Fitting
    choice : Choice
    columns : (p, s k) array
        Projected, of all parameters of the best model.
    """
    return [*_present(choice, columns), *_plain(fitting, choice)]


def is_plain(start: Start) -> bool:
    """Whether a kind is linear in its only parameter."""
    return start.amplitude == start.free and len(start.free) == 1


def _present(choice: Choice, columns: Floats) -> Iterator[Piece]:
    """The effects that are there; what one does now follows from the parameters in which it is linear."""
    model = choice.best.model
    for index, tried in enumerate(choice.rounds):
        start, places = tried[0].start, model.places(index)
        sizes = [places[key] for key in start.amplitude]
        scale = np.array([model.parameters[i].value - start.neutral for i in sizes])
        yield Piece(start, index, columns[[places[key] for key in start.free]], scale @ columns[sizes])


def _plain(fitting: Fitting, choice: Choice) -> Iterator[Piece]:
    """Plain kinds beside the effects that are there."""
    experiment, there = fitting.experiment, {tried[0].label for tried in choice.rounds}
    motion = experiment.motion(choice.best.model.spec, fitting.windows)
    starts: dict[tuple[str, str, str], Start] = {}
    for start in candidates(choice.base.model.spec, experiment.evidence, motion, fitting.sigma):
        if is_plain(start) and start.label not in there:
            starts.setdefault(start.label, start)
    changes = fitting.cores.each(lambda start: _change(fitting, choice, start), starts.values())
    for start, change in zip(starts.values(), changes, strict=True):
        if change is not None and np.isfinite(change).all() and change.any():
            yield Piece(start, None, change[None], np.zeros_like(change))


def _change(fitting: Fitting, choice: Choice, start: Start) -> Floats | None:
    """Change of the prediction with a plain kind; None where it cannot be beside what is there."""
    model = _grown(choice.best.model, start) or start.added_to(choice.best.model)
    try:
        return fitting.projected(choice.best.residual - fitting.residual(model))
    except InputError:
        return None


def _grown(model: Model, start: Start) -> Model | None:
    """Model in which an effect that has the plain kind in it grows by that; None where there is none."""
    values = model.values
    for index, one in enumerate(model.added):
        for plainer in one.law.plainer:
            if plainer.grows and (one.block, plainer.kind, one.place) == start.label:
                places = model.places(index)
                values[[places[key] for key in plainer.grows]] += start.trial
                return model.at(values)
    return None
