"""Effects of which combinations are made: those that were found, and what could be beside them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.search import NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.candidates import candidates
from rthm_analysis.diagnosis.search.judging import Selection, looked_for
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.tones import harmonic_starts
from rthm_core.compiled import Floats
from rthm_core.errors import InputError


@dataclass(frozen=True)
class Piece:
    """An effect that a combination may have.

    Attributes
    ----------
    start : InitialGuess
        Of what is not there, with the trial's size.
    index : int or None
        Place among the effects that are there; None of what is not.
    columns : (c, u k) array
        Thinned change of the prediction with its parameters; of what is not there, with its size over the
        trial's; of a tone that is not there, with that in phase with the trial and with that a quarter of a
        period ahead.
    whole : (u k,) array
        What it does now.
    """

    start: InitialGuess
    index: int | None
    columns: Floats
    whole: Floats

    @property
    def bends(self) -> bool:
        """Whether it is not there, and more than its size has to be found."""
        return self.index is None and not is_plain(self.start) and len(self.columns) == 1

    @property
    def stays(self) -> bool:
        """Whether no combination can do without it: it is linear in nothing."""
        return self.index is not None and not self.start.amplitude

    @property
    def is_positive(self) -> bool:
        """Whether its size cannot be negative: it takes energy out."""
        return self.index is None and len(self.columns) == 1 and not self.start.signed

    def sized(self, sizes: Floats) -> Piece:
        """What is not there, with these factors on its columns."""
        if self.index is not None:
            return self
        start = self.start.sized(float(np.hypot.reduce(sizes)) if sizes.size > 1 else float(sizes[0]))
        if sizes.size > 1:
            start = _ahead(start, float(np.arctan2(sizes[1], sizes[0])))
        return Piece(start, None, self.columns, sizes @ self.columns)


def pieces_of(fitting: Fitting, selection: Selection, columns: Floats, residual: Floats) -> list[Piece]:
    """What combinations are made of.

    Parameters
    ----------
    fitting : Fitting
    selection : Selection
    columns : (p, u k) array
        Thinned, of all parameters of the best model.
    residual : (s k,) array
        What that leaves.
    """
    tones = [] if fitting.simple else _tones(fitting, selection, residual)
    return [*_present(selection, columns), *_others(fitting, selection, residual), *tones]


def is_plain(start: InitialGuess) -> bool:
    """Whether a kind is linear in its only parameter."""
    return start.amplitude == start.free and len(start.free) == 1


def _present(selection: Selection, columns: Floats) -> Iterator[Piece]:
    """The effects that are there; what one does now follows from the parameters in which it is linear."""
    model = selection.best.model
    for index, tried in enumerate(selection.rounds):
        start, places = tried[0].start, model.places(index)
        sizes = [places[key] for key in start.amplitude]
        scale = np.array([model.parameters[i].value - start.neutral for i in sizes])
        yield Piece(start, index, columns[[places[key] for key in start.free]], scale @ columns[sizes])


def _others(fitting: Fitting, selection: Selection, residual: Floats) -> Iterator[Piece]:
    """What could be beside the effects that are there, each linear in its size.

    Near the noise these are the plain kinds: what others are like depends on more than their size, and no
    start has it right.
    """
    experiment, there = fitting.experiment, {tried[0].label for tried in selection.rounds}
    motion = experiment.motion(selection.best.model.spec, fitting.windows)
    starts: dict[object, InitialGuess] = {}
    every = candidates(selection.base.model.spec, experiment.evidence, motion, fitting.sigma)
    for start in looked_for(fitting, every):
        plain = is_plain(start)
        if start.label not in there and start.amplitude and (plain or fitting.reduced_chi2 > NEAR_NOISE_CHI2):
            starts.setdefault(start.label if plain else len(starts), start)
    changes = fitting.cores.each(lambda start: _change(fitting, selection, residual, start), starts.values())
    for start, change in zip(starts.values(), changes, strict=True):
        if change is not None:
            yield Piece(start, None, change[None], np.zeros_like(change))


def _tones(fitting: Fitting, selection: Selection, residual: Floats) -> Iterator[Piece]:
    """Tones in what is left now, and in what was left before any effect was there."""
    starts: list[InitialGuess] = []
    for fitted in (selection.best, selection.base) if selection.rounds else (selection.base,):
        its = fitting.residual(fitted.model).reshape(fitting.weight.shape)
        left = np.where(fitting.weight > 0.0, its, np.nan)
        for start in harmonic_starts(fitted.model.spec, fitting.experiment, left, fitting.sigma):
            if all(abs(_frequency(start) - _frequency(one)) > start.scales["frequency"] for one in starts):
                starts.append(start)
    there = {tried[0].label for tried in selection.rounds}
    both = [s for start in starts if start.label not in there for s in (start, _ahead(start, 0.5 * np.pi))]
    changes = fitting.cores.each(lambda start: _change(fitting, selection, residual, start), both)
    for start, change, ahead in zip(both[::2], changes[::2], changes[1::2], strict=True):
        if change is not None and ahead is not None:
            yield Piece(start, None, np.stack([change, ahead]), np.zeros_like(change))


def _frequency(start: InitialGuess) -> float:
    return float(start.added.parameters["frequency"])


def _ahead(start: InitialGuess, phase: float) -> InitialGuess:
    """The same tone, ahead by some phase in rad."""
    values = start.added.parameters | {"phase": float(start.added.parameters["phase"]) + phase}
    return start.having(values)


def _change(fitting: Fitting, selection: Selection, residual: Floats, start: InitialGuess) -> Floats | None:
    """Thinned change of the prediction with an effect; None where there is none, or it cannot be there."""
    model = _grown(selection.best.model, start) or start.added_to(selection.best.model)
    try:
        change = fitting.thinned(fitting.projected(residual - fitting.residual(model)))
    except InputError:
        return None
    return change if np.isfinite(change).all() and change.any() else None


def _grown(model: Model, start: InitialGuess) -> Model | None:
    """Model in which an effect that has the plain kind in it grows by that; None where there is none."""
    values = model.values
    for index, one in enumerate(model.added):
        for plainer in one.law.plainer:
            if plainer.grows and (one.block, plainer.kind, one.place) == start.label:
                places = model.places(index)
                values[[places[key] for key in plainer.grows]] += start.trial
                return model.at(values)
    return None
