"""Fit models to a recording: weighted residuals, sensitivities, Levenberg-Marquardt, and cross-validation.

Unknown initial states of the free runs are taken out of everything by projection, so that no fit spends its
effort on them. All sums of squares are in units of the noise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import (
    COLUMN_SAMPLES,
    CROSS_VALIDATION_PARTS,
    DIFFERENCE_STEP,
    DIVERGED_ERROR,
    FINE_DIFFERENCE_RATIO,
    FINE_FIT_GAIN,
    FIT_GAIN,
    FIT_STEPS,
    LEAST_DAMPING,
    POOR_FIT_CHI2,
    SETTLED_GAIN,
)
from rthm_analysis.diagnosis.criteria.replay import FITS_AT_ONCE
from rthm_analysis.diagnosis.fitting.colour import Colour, whitened_from
from rthm_analysis.diagnosis.fitting.cores import A, B, Cores
from rthm_analysis.diagnosis.fitting.steps import moved, trial_step
from rthm_analysis.diagnosis.fitting.sums import Sums
from rthm_analysis.diagnosis.fitting.wires_alone import WiresAlone
from rthm_analysis.diagnosis.replay.budget import Budget
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats

Bases = list[tuple[slice, Floats]]
"""Orthonormal bases of what initial states can explain, in the training part of each free run."""


@dataclass(frozen=True)
class Fitted:
    """A model at its best.

    Attributes
    ----------
    model : Model
    squares : float
        Squared error on the training data, in units of the noise, priors included.
    sums : Sums
    samples : int
        Values (s k) that it was fitted to.
    settled : float
        Part of the squared error that a step no longer gained where the fit ended; inf where it ended sooner.
    """

    model: Model
    squares: float
    sums: Sums
    samples: int
    settled: float = np.inf

    @property
    def left_out(self) -> Floats:
        """Cross-validated squared error by block."""
        return self.sums.left_out()


def bounded(errors: Floats) -> Floats:
    """Errors with `DIVERGED_ERROR` in the place of what is larger or not finite."""
    return np.clip(np.nan_to_num(errors, nan=DIVERGED_ERROR), -DIVERGED_ERROR, DIVERGED_ERROR)


@dataclass
class Fitting:
    """Fits of the training part of one recording: the experiment holds nothing else.

    Parameters
    ----------
    experiment : Experiment
    windows : Windows
    sigma : (k,) array
        Noise of the channels, where it has a colour that of its innovations; inf leaves a channel out.
    base : Model
        Where the sensitivities to the initial states are taken at first.
    colours : tuple of k Colour
        Of the noise of the channels; empty: all is white.
    reduced_chi2 : float
        Squared error per sample, in units of the noise, of the best model so far, at least 1: as long as a
        model is wrong, data count less against what the spec states.
    asked : set
        Combinations of effects that were fitted.
    simple : bool
        Whether no effect is looked for that can imitate others.
    identified : dict
        By wire: the kind that explains its measured force, beside which no other is looked for in that wire.

    Attributes
    ----------
    expected : float
        Squared error that noise alone would leave: one for each sample that counts.
    """

    experiment: Experiment
    windows: Windows
    sigma: Floats
    base: Model
    progress: Callable[[str], None] = lambda said: None
    reduced_chi2: float = 1.0
    colours: tuple[Colour, ...] = ()
    cores: Cores = field(default_factory=Cores)
    asked: set[frozenset[tuple[str, str, str]]] = field(default_factory=set)
    simple: bool = False
    identified: dict[str, str] = field(default_factory=dict)
    _bases: Bases = field(default_factory=list)

    def __post_init__(self) -> None:
        measured = self.experiment.evidence.measured
        self.channels = measured.shape[1]
        self.weight = np.where(np.isfinite(measured), 1.0 / self.sigma, 0.0)
        self.expected = float(np.count_nonzero(self.weight))
        self.measured = np.nan_to_num(measured)
        edges = np.linspace(0, measured.shape[0], CROSS_VALIDATION_PARTS + 1).astype(int)
        self.edges = np.union1d(edges, self.experiment.evidence.begins)
        self.blocks = [slice(int(a) * self.channels, int(b) * self.channels) for a, b in pairwise(self.edges)]
        self.rebase(self.base)

    @property
    def whites(self) -> list[bool]:
        """Of each channel whether its noise is white."""
        return [colour.is_white for colour in self.colours] or [True] * self.channels

    @property
    def budget(self) -> Budget:
        """The work that was done, and may be done."""
        return self.experiment.budget

    @property
    def _apart(self) -> int:
        """Of how many samples one is asked where hundreds of columns are needed at once."""
        return max(1, len(self.measured) // COLUMN_SAMPLES)

    def thinned(self, columns: Floats) -> Floats:
        """Columns (..., s k) at the samples that are then asked: (..., u k)."""
        if self._apart == 1:
            return columns
        rows = columns.reshape(*columns.shape[:-1], *self.measured.shape)[..., :: self._apart, :]
        return rows.reshape(*columns.shape[:-1], rows.shape[-2] * self.channels)

    @property
    def thinned_blocks(self) -> list[slice]:
        """Where the blocks are among these samples."""
        ends = -(-self.edges // self._apart) * self.channels
        return [slice(int(a), int(b)) for a, b in pairwise(ends)]

    @cached_property
    def wires_alone(self) -> WiresAlone:
        """Check of the wires by their own forces."""
        return WiresAlone(self.experiment, self.base.spec, self.sigma)

    def each_affordable(self, work: Callable[[A], B], items: Sequence[A]) -> list[B]:
        """Do some work for the first items, a few side by side, until the budget is spent."""
        done: list[B] = []
        while len(done) < len(items) and not (done and self.budget.spent):
            done += self.cores.each_in_parts(work, items[len(done) : len(done) + FITS_AT_ONCE])
        return done

    def residual(self, model: Model, windows: Windows | None = None) -> Floats:
        """Measured minus predicted, over the noise and whitened: (s k,)."""
        return self.errors(self.experiment.predicted(model.spec, windows or self.windows))

    def errors(self, predicted: Floats) -> Floats:
        """Errors (s k,) of what was predicted (s, k), over the noise and whitened."""
        errors = (self.measured - predicted) * self.weight
        return whitened_from(errors, self.colours, self.windows.start).ravel()

    def weighed(self, changes: Floats) -> Floats:
        """Changes (p, s, k) of what is predicted, over the noise and whitened: (p, s k)."""
        rows = (whitened_from(one * self.weight, self.colours, self.windows.start) for one in changes)
        return np.stack([one.ravel() for one in rows])

    def squares(self, model: Model) -> float:
        """Squared error of a model as it stands, in units of the noise; inf where it diverges."""
        residual = self.residual(model)
        return self._cost(model, residual, self._bases_of(model, residual))

    def squares_near(self, model: Model, others: Sequence[Model]) -> list[float]:
        """The same of others that are so near that initial states do with them what they do with it."""
        bases = self._bases_of(model, self.residual(model))
        return self.cores.each(lambda one: self._cost(one, self.residual(one), bases), others)

    def rebase(self, model: Model) -> None:
        """Take the sensitivities to the initial states at a model that is nearer to the recording."""
        self._bases = self.bases(self.states(model, self.residual(model)))

    @contextmanager
    def based_on(self, model: Model) -> Iterator[None]:
        """Take the sensitivities to the initial states at another model for a while."""
        before = self._bases
        self.rebase(model)
        try:
            yield
        finally:
            self._bases = before

    @contextmanager
    def simple_only(self) -> Iterator[None]:
        """Look for no effect that can imitate others for a while."""
        before, self.simple = self.simple, True
        try:
            yield
        finally:
            self.simple = before

    @contextmanager
    def identified_as(self, kind: str, wire: str) -> Iterator[None]:
        """Look for no other kind in a wire for a while."""
        before = self.identified
        self.identified = before | {wire: kind}
        try:
            yield
        finally:
            self.identified = before

    def states(self, model: Model, here: Floats) -> Floats:
        """Change of the prediction with the initial states (2 n, s k), over the noise."""
        size = 1e-3 * (float(np.nanstd(self.experiment.evidence.measured[:, 0])) or 1.0)

        def one(i: int) -> Floats:
            return (here - self.residual(model, self.windows.moved(i, size))) / size

        return np.stack(self.cores.each(one, range(self.windows.state.shape[1])))

    def bases(self, states: Floats) -> Bases:
        """Orthonormal bases of the changes with the initial states."""
        found = []
        ends = np.append(self.windows.start[1:], self.measured.shape[0])
        for begin, end in zip(self.windows.start, ends, strict=True):
            part = slice(int(begin) * self.channels, int(end) * self.channels)
            found.append((part, _basis(states[:, part].T)))
        return found

    def projected(self, columns: Floats, bases: Bases | None = None) -> Floats:
        """Some columns (..., s k) without what initial states can explain."""
        return self._cleared(np.array(columns), self._bases if bases is None else bases)

    @staticmethod
    def _cleared(columns: Floats, bases: Bases) -> Floats:
        """The same, in the place of the columns: those of a long recording are large."""
        for part, basis in bases:
            columns[..., part] -= (columns[..., part] @ basis) @ basis.T
        return columns

    def state_correction(self, fitted: Fitted) -> Floats:
        """Change (2 n,) of the initial state of the only run that fits best; zero where there are several."""
        unchanged = np.zeros(self.windows.state.shape[1])
        if not self.windows.is_one:
            return unchanged
        residual = self.residual(fitted.model)
        states = self.states(fitted.model, residual)
        if not np.isfinite(residual).all() or not np.isfinite(states).all():
            return unchanged
        return np.asarray(np.linalg.lstsq(states.T, residual, rcond=1e-10)[0])

    def corrected(self, windows: Windows, fitted: Fitted) -> Windows:
        """Windows that begin in the initial state which fits a model best (`state_correction`); as they are
        where the fit sees more left from there, as the model is not linear over so large a step.
        """
        by = self.state_correction(fitted)
        left = self.residual(fitted.model, self.windows.at(self.windows.state + by))
        before = self.residual(fitted.model)
        is_better = left @ left < before @ before
        return windows.at(windows.state + by) if is_better else windows

    def columns(
        self,
        model: Model,
        residual: Floats,
        which: Iterable[int],
        small: float = DIFFERENCE_STEP,
        bases: Bases | None = None,
    ) -> Floats:
        """Projected change of the prediction with some parameters (p, s k), over the noise."""
        places = list(which)
        columns = np.empty((len(places), residual.size))

        def one(row: int) -> None:
            parameter = model.parameters[places[row]]
            step = trial_step(parameter, small)
            values = model.values
            values[places[row]] += step
            columns[row] = (residual - self.residual(model.at(values))) / step

        self.cores.each(one, range(len(places)))
        if not np.isfinite(columns).all():
            raise np.linalg.LinAlgError("a model has no finite sensitivities")
        return self._cleared(columns, self._bases if bases is None else bases)

    def known(self, fitted: Fitted) -> Floats:
        """Projected columns of a fitted model; none where a small change of a parameter makes it diverge."""
        return self.known_of(fitted.model, self.residual(fitted.model))

    def known_of(self, model: Model, residual: Floats) -> Floats:
        """The same of a model that leaves some residual."""
        try:
            return self.columns(model, residual, range(len(model.parameters)))
        except np.linalg.LinAlgError:
            return np.empty((0, residual.size))

    def sums(self, model: Model, residual: Floats, columns: Floats) -> Sums:
        """Normal equations of a model whose residual and columns are known and projected."""
        priors = [p.prior for p in model.parameters]
        precision = self.reduced_chi2 * np.array([0.0 if p is None else p[1] ** -2 for p in priors])
        pull = self.reduced_chi2 * np.array(
            [0.0 if p is None else (p[0] - v) / p[1] ** 2 for p, v in zip(priors, model.values, strict=True)]
        )
        hessian = np.stack([columns[:, b] @ columns[:, b].T for b in self.blocks])
        gradient = np.stack([columns[:, b] @ residual[b] for b in self.blocks])
        squares = np.array([float(residual[b] @ residual[b]) for b in self.blocks])
        return Sums(hessian, gradient, squares, precision, pull)

    def fit(
        self,
        model: Model,
        known: Floats | None = None,
        most: int = FIT_STEPS,
        least: float = FIT_GAIN,
        *,
        started: bool = False,
        affordable: bool = False,
    ) -> Fitted:
        """Levenberg-Marquardt from the model's present values.

        Parameters
        ----------
        model : Model
        known : (q, s k) array, optional
            Columns of the first q parameters, which then are not computed anew.
        most : int
            Largest number of steps.
        least : float
            Part of the squared error below which a step gains too little to go on.
        started : bool
            Whether the free runs start exactly where they are said to.
        affordable : bool
            Whether to end with the step that spends the budget; only where nothing is done side by side.
        """
        anew = known is None or self.reduced_chi2 > POOR_FIT_CHI2
        kept = 0 if anew or known is None else known.shape[0]
        residual = self.residual(model)
        bases = self._bases_of(model, residual, started=started)
        best, damping = self._cost(model, residual, bases), LEAST_DAMPING
        columns, small, settled = np.empty((0, residual.size)), DIFFERENCE_STEP, np.inf
        for _ in range(most):
            free = range(kept, len(model.parameters))
            columns = self.columns(model, residual, free, small, bases)
            columns = np.vstack([known, columns]) if kept and known is not None else columns
            sums = self.sums(model, self.projected(residual, bases), columns)
            if not len(model.parameters):
                break
            before, from_here = best, (model, residual, bases)
            for _ in range(6):
                trial = model.at(moved(model, sums, damping))
                trial_residual = self.residual(trial)
                cost = self._cost(trial, trial_residual, bases)
                if cost < best:
                    model, residual, best, damping = trial, trial_residual, cost, damping * 0.1
                    break
                damping = max(damping * 10.0, 10.0 * LEAST_DAMPING)
            if affordable and self.budget.spent:
                break
            if before - best < max(SETTLED_GAIN, least * best):
                if small < DIFFERENCE_STEP or least > FINE_FIT_GAIN:
                    settled = least
                    break
                # Where motions part quickly, a longer step tells little, and refused steps were its fault.
                small, damping = DIFFERENCE_STEP * FINE_DIFFERENCE_RATIO, LEAST_DAMPING
            if self.reduced_chi2 > POOR_FIT_CHI2:
                bases = self._bases_of(model, residual, started=started)
                best = self._cost(model, residual, bases)
                if best > before:  # initial states do not explain there what they did here
                    (model, residual, bases), best, damping = from_here, before, 100.0 * damping
        sums = self.sums(model, self.projected(residual, bases), columns)
        return Fitted(model, best, sums, residual.size, settled)

    def _bases_of(self, model: Model, residual: Floats, *, started: bool = False) -> Bases:
        """What initial states can explain: of this model as long as models are wrong, else of the base.

        Nothing where the states in which the runs started are taken for exact.
        """
        if started:
            return []
        return self.bases(self.states(model, residual)) if self.reduced_chi2 > POOR_FIT_CHI2 else self._bases

    def _cost(self, model: Model, residual: Floats, bases: Bases) -> float:
        priors = [(p.value - p.prior[0]) / p.prior[1] for p in model.parameters if p.prior]
        kept = self.projected(residual, bases)
        cost = float(kept @ kept) + self.reduced_chi2 * float(np.square(priors).sum())
        return cost if np.isfinite(cost) else np.inf


def _basis(columns: Floats) -> Floats:
    """Orthonormal basis of the columns (rows, c); empty where a model diverges: its cost is infinite."""
    if not np.isfinite(columns).all():
        return np.empty((columns.shape[0], 0))
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300)])
