"""A formula before the long search: where no single kind is enough, one term of no kind may be."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.missing import (
    FORMULA_FITS,
    LOAD_LAW_SHARE,
    SAMPLED_TRAINED,
)
from rthm_analysis.diagnosis.criteria.search import AHEAD_LEFT_SHARE, NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.fitting.noise import white_noise
from rthm_analysis.diagnosis.missing.curves import CurveFit, Regression, free_curves
from rthm_analysis.diagnosis.missing.formulas import composed, fitted_together, has_plain
from rthm_analysis.diagnosis.missing.likely import likely
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.physical.beginning import Baseline
from rthm_analysis.diagnosis.physical.drafting import draft_of
from rthm_analysis.diagnosis.physical.driven import forces_are_off
from rthm_analysis.diagnosis.physical.formula_model import fit_terms, guess_of, rounds_of, with_all
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.physical.wire_curves import beyond, foretold_share
from rthm_analysis.diagnosis.physical.wire_guesses import terms_of
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import Selection, reduced_chi2
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.registry import own_laws


@dataclass
class FormulaFirst:
    """Asks for a formula of the training part once, when the first effect of a search is not enough.

    Parameters
    ----------
    whole, near : Baseline
        Over the whole training part, and in runs in which a wrong model stays near: maybe the same.

    Attributes
    ----------
    found : (Baseline, Selection) or None
        Formulas of wires, or one term of no kind of the library, maybe beside a constant, that leave nothing
        but noise, and the runs in which they do; nothing where only a curve over the known load does, which
        no kind is.
    """

    whole: Baseline
    near: Baseline
    found: tuple[Baseline, Selection] | None = None
    _asked: bool = field(default=False, repr=False)
    _left: float = field(default=np.inf, repr=False)

    def is_enough(self, left: float) -> bool:
        """Whether a search that leaves so much (reduced chi-squared) may end, as a formula leaves nothing.

        It is asked once, and only where much is left. A formula that leaves next to nothing of it ends the
        search, too: what it leaves is looked for beside it.
        """
        if left > NEAR_NOISE_CHI2:
            self.ask()
        if self.found is None and self._left < POOR_FIT_CHI2 and self._left - 1.0 < AHEAD_LEFT_SHARE * left:
            self.found = self._nothing
        return self.found is not None

    @property
    def _nothing(self) -> tuple[Baseline, Selection]:
        return self.near, Selection(self.near.retuned, self.near.retuned)

    def ask(self) -> None:
        """Ask, unless it was asked before.

        Not where somebody has declared laws of his own: he asks for their names.
        """
        if not self._asked and not own_laws("plant"):
            self._asked = True
            self.found = self._find()
            if self.found is None:
                self.near.fitting.budget.lose()

    def _find(self) -> tuple[Baseline, Selection] | None:
        fitting, retuned, noise = self.near.fitting, self.near.retuned, self.near.noise
        fitting.progress("looking for a formula of the missing force")
        if (guesses := self._of_wires()) and (
            found := self._enough(guesses, self.near.retuned.model)
        ) is not None:
            return found
        if (draft := draft_of(self.near)) is not None:
            fitting, retuned, noise = draft.fitting, draft.retuned, white_noise(noise.level)
        samples = fitting.experiment.evidence.time.size
        left = Regression(fitting.experiment, fitting.windows, noise, retuned.model, samples)
        among = likely(self.near.fitting.experiment, self.near.fitting.windows, self.near.retuned.model.spec)
        curves = free_curves(left, among)
        plain = _terms(left, curves, plain=True)
        found = self._by_terms(left, plain)
        if found is None and has_plain(plain):
            found = self._by_terms(left, _terms(left, curves, plain=False))
        if found is None and _is_of_load(curves):
            return self._nothing
        return found

    def _by_terms(self, left: Regression, terms: tuple[Term, ...]) -> tuple[Baseline, Selection] | None:
        if all(one.is_known for one in terms):
            return None
        model, terms = fitted_together(left, terms)
        return self._enough([guess_of(one) for one in terms], model)

    def _of_wires(self) -> list[InitialGuess]:
        """Terms of wires that their own forces say are no linear springs."""
        fitting, models = self.near.fitting, (self.near.nominal.model, self.near.retuned.model)
        if own_laws("wire") or not forces_are_off(fitting.wires_alone, models):
            return []
        samples = fitting.experiment.evidence.time.size
        wires = beyond(fitting.experiment, fitting.windows, models[1].spec, self.near.noise.level)
        train = int(SAMPLED_TRAINED * samples)
        return terms_of([one for one in wires if foretold_share(one, train) is not None], samples)

    def _enough(self, guesses: list[InitialGuess], model: Model) -> tuple[Baseline, Selection] | None:
        """A model with some formulas, if it leaves nothing but noise."""
        near = _fitted(self.near, with_all(model, guesses))
        if near is None:
            return None
        apart = self.whole is not self.near
        whole = _fitted(self.whole, near.fitted.model) if apart else None
        self._left = min(self._left, (whole or near).left)
        for begun, one in ((self.whole, whole), (self.near, near)):
            if one is not None and one.at_noise:
                begun.fitting.rebase(one.fitted.model)
                begun.fitting.reduced_chi2 = reduced_chi2(begun.fitting, one.fitted)
                return begun, Selection(begun.retuned, one.fitted, rounds_of(guesses, one.fitted))
        return None


def _terms(left: Regression, curves: list[CurveFit], *, plain: bool) -> tuple[Term, ...]:
    """One term, or two that are one law."""
    terms = composed(left, curves, most=2, plain=plain)
    return terms if len(terms) == 2 and _belong_together(*terms) else terms[:1]


def _belong_together(one: Term, other: Term) -> bool:
    """Whether two terms are one law: with a constant, both of the load alone, or without numbers of their
    own.
    """
    return (
        other.is_constant
        or one.depends_on == other.depends_on == ("load",)
        or not (one.within or other.within)
    )


def _is_of_load(curves: list[CurveFit]) -> bool:
    """Whether a curve over the known load alone explains nearly all."""
    best = max(curves, key=lambda one: one.gain, default=None)
    return best is not None and best.feature.depends_on == ("load",) and best.share > LOAD_LAW_SHARE


class _Try(NamedTuple):
    """A fit, whether it leaves nothing but noise, and the reduced chi-squared that it leaves."""

    fitted: Fitted
    at_noise: bool
    left: float


def _fitted(begun: Baseline, model: Model) -> _Try | None:
    """Fit of a model that is near the noise, after which all is as it was; None where it diverges."""
    fitting = begun.fitting
    before, fitting.reduced_chi2 = fitting.reduced_chi2, 1.0
    with fitting.based_on(begun.retuned.model):
        fitted = fit_terms(fitting, model)
        if fitted is not None and NEAR_NOISE_CHI2 < reduced_chi2(fitting, fitted) < POOR_FIT_CHI2:
            fitted = fit_terms(fitting, fitted.model, FORMULA_FITS) or fitted
        found = None
        if fitted is not None:
            found = _Try(fitted, at_noise(fitting, fitted), reduced_chi2(fitting, fitted))
    fitting.reduced_chi2 = before
    return found
