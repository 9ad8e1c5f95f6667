"""Which free curve predicts data that chose nothing, and how much of what a model leaves it explains."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import DIFFERENCE_STEP, POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.missing import (
    CURVE_STIFFNESSES,
    CURVE_TRIAL_FORCE_RATIO,
    FORMULA_STEPS,
    MOST_RESPONSE_BYTES,
    REGRESSION_PERIOD_SHARE,
    REGRESSION_SAMPLES,
    RESPONSES_AT_ONCE,
)
from rthm_analysis.diagnosis.criteria.replay import LINEAR_STEP_COST
from rthm_analysis.diagnosis.criteria.verdict import DRAFT_FEWEST_IN_WINDOW
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.fitting.noise import Noise
from rthm_analysis.diagnosis.fitting.steps import trial_step
from rthm_analysis.diagnosis.missing.features import Feature, features
from rthm_analysis.diagnosis.missing.motion import Along, along
from rthm_analysis.diagnosis.missing.normal import Normal, normal_of, solved, squares
from rthm_analysis.diagnosis.missing.sites import sites
from rthm_analysis.diagnosis.replay.budget import Budget, budget_for
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.linear import linear_response
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats, Integers


@dataclass(frozen=True)
class CurveFit:
    """A free curve fitted to what a model leaves.

    Attributes
    ----------
    site : str
    feature : Feature
    sizes, stds : (p,) arrays
        Of its shapes, N.
    gain : float
        Squared error that it removes where the fit did not see it (cross-validated), in units of the noise.
    excess : float
        Squared error of the model above the noise, in the same data.
    held_out_gain, held_out_excess : float
        The same in the part that chose nothing.
    at : Along
    pulls, bent : (s, q), (q,) arrays
        Forces of what damping and stiffness changed by when the curve was fitted, of size 1, N, and their
        sizes.
    normal : Normal, optional
        Normal equations of the training part: of what is known first, then of its shapes.
    loose : CurveFit, optional
        The same without its sizes held together: a jump among them is then no larger than the data say.
    """

    site: str
    feature: Feature
    sizes: Floats
    stds: Floats
    gain: float
    excess: float
    held_out_gain: float
    held_out_excess: float
    at: Along
    pulls: Floats
    bent: Floats
    normal: Normal | None = None
    loose: CurveFit | None = None

    @property
    def yardstick(self) -> CurveFit:
        """The fit by which kinds are judged."""
        return self.loose or self

    @property
    def share(self) -> float:
        """Part of the mismatch that it explains in data left out of its fit."""
        return self.gain / max(self.excess, 1e-300)

    @property
    def held_out_share(self) -> float:
        """The same in the part that chose nothing."""
        return self.held_out_gain / max(self.held_out_excess, 1e-300)

    @property
    def force(self) -> Floats:
        """Force (s,) along the recording beside the model as it stands, N."""
        return self.feature.force(self.sizes) + self.pulls @ self.bent

    @property
    def largest(self) -> float:
        """Force that it hardly ever exceeds, N."""
        return float(np.quantile(np.abs(self.force), 0.995))


class Regression:
    """What a model leaves of the whole recording, and the response of its channels to any force.

    Forces are given at all samples (s). Of a long recording their responses are asked at some of these (u):
    there are hundreds, and each is smooth from sample to sample. Its replays are counted apart: what is asked
    of a force takes nothing from the search for kinds.

    Parameters
    ----------
    experiment : Experiment
        Over the whole recording, or a draft of it.
    windows : Windows
    noise : Noise
    model : Model
    train : int
        Samples that choose; the others confirm.
    budget : Budget, optional
        That it shares with others; by default one of its own.
    """

    def __init__(
        self,
        experiment: Experiment,
        windows: Windows,
        noise: Noise,
        model: Model,
        train: int,
        budget: Budget | None = None,
    ) -> None:
        draft = experiment if experiment.is_draft else experiment.draft()
        budget = budget or budget_for(draft.evidence.stamps_ns.size, FORMULA_STEPS)
        self.experiment, self.windows, self.model = replace(draft, budget=budget), windows, model
        self.fitting, left, kept = _some_samples(self.experiment, windows, noise, model)
        self.here = self.fitting.residual(model)
        some = self.fitting.experiment.evidence, self.fitting.windows.start
        self._linear = linear_response(model.spec, self.experiment.evidence, *some)
        self.left, blocks = self.fitting.thinned(left), self.fitting.thinned_blocks
        last = np.count_nonzero(self.fitting.edges[1:] <= np.searchsorted(kept, train))
        self.train, self.held = blocks[:last], blocks[last:]
        reduced_chi2 = max(1.0, squares(left) / max(self.fitting.expected, 1.0))
        self.motion = self.experiment.motion(model.spec, windows)
        self.sites = sites(model.spec)
        self._along = [along(self.experiment.evidence, self.motion, one) for one in self.sites]
        self.motion_forces = self._motion_forces()
        self.known = self._known(far=reduced_chi2 > POOR_FIT_CHI2)
        self.precision = reduced_chi2 * _precision(model)[: self.known.shape[0]]
        self._responses: dict[tuple[Feature, int], Floats] = {}

    @property
    def spent(self) -> bool:
        """Whether no further question should be asked of it."""
        return self.experiment.budget.spent

    def site(self, name: str) -> int:
        """Number of a site."""
        return [one.name for one in self.sites].index(name)

    def along(self, site: int) -> Along:
        """Motion at a site along the recording."""
        return self._along[site]

    def beside(self, columns: Floats) -> Regression:
        """The same with further forces whose responses (q, u k) are known and whose sizes are free."""
        more = copy(self)
        vars(more).pop("left_known", None)
        more.known = np.vstack([self.known, columns * self._scales_of(columns)[:, None]])
        return more

    def _scales_of(self, responses: Floats) -> Floats:
        """Factors (q,) that make responses as large as those that are known: terms of different units then
        weigh alike.
        """
        known, own = (np.linalg.norm(rows, axis=1) for rows in (self.known, responses))
        usual = float(known.max(initial=0.0)) or 1.0
        return np.asarray(np.where(own > 0.0, usual / np.where(own > 0.0, own, 1.0), 1.0))

    def response(self, shapes: Floats, site: int) -> Floats:
        """Change of all channels (p, u k) with the size of each shape (s, p), over the noise, whitened."""
        return self._responses_of(lambda i: np.asarray(shapes[:, i]), shapes.shape[1], site)

    def _responses_of(self, shape: Callable[[int], Floats], count: int, site: int) -> Floats:
        """The same of so many shapes (s,), each made where it is asked for."""
        cores = self.fitting.cores
        if self._linear is None:
            return np.stack(cores.each(lambda i: self._response(shape(i), site), range(count)))

        def together(first: int) -> Floats:
            some = range(first, min(first + RESPONSES_AT_ONCE, count))
            return self._linear_response(np.stack([shape(i) for i in some], axis=1), site)

        return np.concatenate(cores.each(together, range(0, count, RESPONSES_AT_ONCE)))

    def _linear_response(self, shapes: Floats, site: int) -> Floats:
        """The same (p, u k) of some shapes (s, p) where nothing bends."""
        assert self._linear is not None
        self.experiment.budget.charge(LINEAR_STEP_COST * shapes.size)
        change = self.fitting.weighed(self._linear.to(shapes, self.sites[site].place))
        return self.fitting.thinned(self.fitting.projected(change))

    def _response(self, shape: Floats, site: int) -> Floats:
        """The same (u k,) of one shape (s,)."""
        force, place = np.zeros_like(self.experiment.evidence.load), self.sites[site].place
        force[:, place.dof] = shape
        if place.other >= 0:
            force[:, place.other] = -shape
        return self._response_to_force(force)

    def _response_to_force(self, force: Floats) -> Floats:
        """The same (u k,) of a force (s, n) on all dofs."""
        trial = CURVE_TRIAL_FORCE_RATIO * self.force_scale
        size = trial / (float(np.abs(force).max()) or 1.0)
        there = self.fitting.experiment.under(size * force, self.experiment.evidence.time)
        predicted = there.predicted(self.model.spec, self.fitting.windows)
        change = (self.here - self.fitting.errors(predicted)) / size
        return self.fitting.thinned(self.fitting.projected(change))

    def _known(self, *, far: bool) -> Floats:
        """Changes (q, u k) with the parameters of the model.

        A model that is `far` from the recording moves otherwise than it: there, a spring and a damper pull
        along the recorded motion, as the missing force does.
        """
        columns = self.fitting.thinned(self.fitting.known_of(self.model, self.here))
        pulling = [i for i in range(columns.shape[0]) if np.any(self.motion_forces[:, :, i])]
        if far and pulling:
            forces = self.motion_forces[:, :, pulling].transpose(2, 0, 1)
            columns[pulling] = self.fitting.cores.each(self._response_to_force, forces)
        return columns

    def _motion_forces(self) -> Floats:
        """Change (s, n, q) of the forces of dampers and springs of the plant with each parameter."""
        assert self.model.spec.plant is not None
        each = self._along[: len(self.model.spec.plant.dofs)]
        x, v = (np.stack(rows, axis=1) for rows in ([one.x for one in each], [one.v for one in each]))
        changes = [_changed(self.model, i) for i in range(len(self.model.parameters))]
        found = [-(v @ damping.T + x @ stiffness.T) for damping, stiffness in changes]
        return np.stack(found, axis=2) if found else np.empty((*x.shape, 0))

    @property
    def force_scale(self) -> float:
        """Force of spring, damper and mass in the recorded motion, N: one of them may be zero."""
        evidence, plant = self.experiment.evidence, self.model.nominal.plant
        assert plant is not None
        rate = 2.0 * np.pi / evidence.period
        laws = ((plant.stiffness, 1.0), (plant.damping, rate), (plant.mass, rate**2))
        size = sum(max(map(abs, entries), default=0.0) * factor for entries, factor in laws)
        return float(np.nanstd(evidence.measured[:, 0])) * size

    def fit(self, feature: Feature, site: int) -> CurveFit | None:
        """Fit a free curve; None where the model diverges under it."""
        response = self._response_to(feature, site)
        whole = self.normal(response)
        if whole is None:
            return None
        first, own, held = self.known.shape[0], self.motion_forces.shape[2], self.held
        base, columns = whole.leading(first), np.vstack([self.known, response])
        left_out, plain = float(base.left_out().sum()), base.sizes
        before = sum(squares(self.left[b] - plain @ columns[:first, b]) for b in held)
        scatter = max(float(np.median(whole.squares / whole.count)), 1.0)

        def held_together(stiffness: float) -> CurveFit:
            stiff = whole.stiffened(feature.roughness, stiffness)
            sizes, inverse = solved(*stiff.total)
            after = sum(squares(self.left[b] - sizes @ columns[:, b]) for b in held)
            return CurveFit(
                self.sites[site].name,
                feature,
                sizes[first:],
                np.sqrt(np.maximum(np.diag(inverse)[first:], 0.0) * scatter),
                left_out - float(stiff.left_out().sum()),
                left_out - float(whole.count.sum()),
                float(before - after),
                float(before - sum(self.left[b].size for b in held)),
                self.along(site),
                self._pulls(site),
                sizes[:own],
                whole,
            )

        loose, *others = map(held_together, CURVE_STIFFNESSES)
        return replace(max([loose, *others], key=lambda one: one.gain), loose=loose)

    def _pulls(self, site: int) -> Floats:
        """Change (s, q) of the force of damper and spring at a site with each parameter: between two dofs,
        that of what couples them.
        """
        place, at = self.sites[site].place, self.along(site)
        if place.other < 0:
            return np.asarray(self.motion_forces[:, place.dof])
        changes = (_changed(self.model, i) for i in range(self.motion_forces.shape[2]))
        coupling = [(damping[place], stiffness[place]) for damping, stiffness in changes]
        found = [c * at.v + k * at.x for c, k in coupling]
        return np.stack(found, axis=1) if found else np.empty((at.t.size, 0))

    @cached_property
    def left_known(self) -> float:
        """Squared error, of data left out, that what is known leaves; inf where the model diverges."""
        known = self.normal(np.empty((0, self.left.size)))
        return np.inf if known is None else float(known.left_out().sum())

    def normal(self, responses: Floats) -> Normal | None:
        """Normal equations of the training part for what is known, then of forces whose responses (q, u k)
        are given; None where the model diverges under them.
        """
        columns = np.vstack([self.known, responses])
        if not np.isfinite(columns).all():
            return None
        return normal_of(columns, self.left, self.train, self.precision)

    def normal_of_any_unit(self, responses: Floats) -> tuple[Normal | None, Floats]:
        """Normal equations as `normal`, of responses that weigh alike; and the factors (q,) that turn their
        sizes into those of the responses that were given.
        """
        scales = self._scales_of(responses)
        return self.normal(responses * scales[:, None]), scales

    def _response_to(self, feature: Feature, site: int) -> Floats:
        """Response to a feature; kept, as the same features are asked again beside others."""
        kept = self._responses.get((feature, site))
        if kept is None:
            kept = self._responses_of(feature.shape, feature.count, site)
            if kept.nbytes + sum(one.nbytes for one in self._responses.values()) < MOST_RESPONSE_BYTES:
                self._responses[feature, site] = kept
        return kept


def _some_samples(
    draft: Experiment, windows: Windows, noise: Noise, model: Model
) -> tuple[Fitting, Floats, Integers]:
    """Fits of the samples of which responses are asked, what a model leaves there, and which they are.

    What is left is that of all samples: coarser steps only show in responses.
    """
    kept, runs = windows.every(_every(draft, windows), draft.evidence.stamps_ns.size)
    if kept.size == draft.evidence.stamps_ns.size:
        fitting = Fitting(draft, windows, noise.sigma, model, colours=noise.colours)
        return fitting, fitting.projected(fitting.residual(model)), kept
    whole = Fitting(draft, windows, noise.level, model)
    left = whole.projected(whole.residual(model)).reshape(whole.measured.shape)[kept].ravel()
    return Fitting(draft.draft(kept), runs, noise.level, model), left, kept


def _every(experiment: Experiment, windows: Windows) -> int:
    """Of how many samples responses are asked of one: in a long recording, as far as its motion and its free
    runs allow.
    """
    evidence = experiment.evidence
    samples, step = evidence.stamps_ns.size, float(np.median(np.diff(evidence.time)))
    shortest = int(np.diff(np.append(windows.start, samples)).min())
    of_motion = int(REGRESSION_PERIOD_SHARE * evidence.period / step)
    return max(1, min(samples // REGRESSION_SAMPLES, of_motion, shortest // DRAFT_FEWEST_IN_WINDOW))


def _precision(model: Model) -> Floats:
    """Of how near the parameters stay to their values beside a curve: a damper and a curve over the velocity,
    each the larger for the other, would follow the noise of the velocity.
    """
    return np.array([(p.prior[1] if p.prior else p.scale) ** -2.0 for p in model.parameters])


def _changed(model: Model, index: int) -> tuple[Floats, Floats]:
    """Change (n, n) of damping and stiffness of the plant with one parameter."""
    parameter, values = model.parameters[index], model.values
    step = trial_step(parameter, DIFFERENCE_STEP)
    values[index] += step
    before, after = model.spec.plant, model.at(values).spec.plant
    assert before is not None and after is not None
    n = len(before.dofs)

    def change(one: Sequence[float], other: Sequence[float]) -> Floats:
        return np.asarray((np.reshape(other, (n, n)) - np.reshape(one, (n, n))) / step)

    return change(before.damping, after.damping), change(before.stiffness, after.stiffness)


def free_curves(regression: Regression, among: Mapping[str, Collection[int]] | None = None) -> list[CurveFit]:
    """Every free curve at every site, the one that explains most of data left out first; of a site in `among`
    those features alone whose numbers it has. Between two dofs none is over time alone: it would be the error
    of a position sensor.
    """
    found = []
    for number, site in enumerate(regression.sites):
        some = (among or {}).get(site.name)
        for place, one in enumerate(features(regression.along(number))):
            is_asked = (some is None or place in some) and not (site.is_pair and one.depends_on == ("t",))
            found += [fit] if is_asked and (fit := regression.fit(one, number)) else []
    return sorted(found, key=lambda one: -one.gain)


def beside(curves: list[CurveFit], regression: Regression, columns: Floats) -> list[CurveFit]:
    """The same curves fitted beside other forces whose responses (q, u k) are known."""
    more = regression.beside(columns)
    found = (more.fit(one.feature, more.site(one.site)) for one in curves)
    return sorted(filter(None, found), key=lambda one: -one.gain)
