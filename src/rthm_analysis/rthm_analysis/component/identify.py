"""From recorded tests of a component to what its force follows from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rthm_analysis.component.criteria import AT_NOISE_RATIO, BETTER_RATIO, SETTLING_SHARE
from rthm_analysis.component.fitting import Fitted, Part, fitted, sized
from rthm_analysis.component.motion import smoothed
from rthm_analysis.component.recorded import Channels, ComponentTest, channels_of, component_test
from rthm_analysis.component.result import ComponentFinding, Errors, Term
from rthm_analysis.component.selecting import Progress, selected
from rthm_analysis.component.shapes import OFFSET
from rthm_analysis.component.told import told
from rthm_analysis.component.words import (
    denied_words,
    error_words,
    reversed_words,
    sampled_words,
    verdict_words,
)
from rthm_analysis.diagnosis.criteria.verdict import TRAINED_SHARE
from rthm_analysis.diagnosis.replay.readings import fast_noise
from rthm_analysis.recording import Recording

MOTION_OF = {"stiffness": ("x",), "damping": ("v",), OFFSET: ()}
"""What the parts without a law depend on."""


def identify_recordings(
    recordings: Sequence[Recording],
    motion: str = "",
    force: str = "",
    inputs: Sequence[str] = (),
    progress: Progress = lambda said: None,
) -> tuple[ComponentFinding, Fitted, ComponentTest]:
    """`identify_component` of recordings in which these signals are motion, force and inputs; with the test
    that confirms it.

    Raises
    ------
    InputError
        If a signal is not there or nothing says which it is, or nothing moves.
    """
    channels = [channels_of(one, motion, force, inputs) for one in recordings]
    tests = [component_test(one, of) for one, of in zip(recordings, channels, strict=True)]
    return *identify_component(tests, channels[0], progress), tests[-1]


def identify_component(
    tests: Sequence[ComponentTest], channels: Channels, progress: Progress = lambda said: None
) -> tuple[ComponentFinding, Fitted]:
    """What the force of a component follows from, confirmed on data that no fit has seen.

    Parameters
    ----------
    tests : sequence of ComponentTest
        Of one component; of several the last confirms what the others show, of one its last third.
    channels : Channels
        Names, for the words.
    progress : callable
        Told what is being done.

    Returns
    -------
    finding : ComponentFinding
    fitted : Fitted
        The model, to draw or to predict with.
    """
    trained, unseen = _divided(tests)
    noise = float(np.sqrt(np.mean([_noise(test) ** 2 for test in tests])))
    selection = selected(trained, noise, progress)
    best, plain = selection.best, selection.plain
    denied = _denied(best, unseen)
    if denied:
        kept = (shape for i, shape in enumerate(best.model.shapes) if i not in denied)
        best = fitted(replace(best.model, shapes=tuple(kept)), trained)
    errors = Errors(_error(plain, unseen), _error(best, unseen), noise)
    verdict = _verdict(errors)
    if denied and verdict == "explained":
        verdict = "improved"
    terms, lags = told(best) if verdict != "unexplained" else ((), {})
    depends_on = _depends_on(best, terms)
    held_out = _held_out(tests, unseen)
    force_std = float(np.std(unseen.test.force[unseen.rows]))
    notes = [error_words(errors, force_std, held_out)]
    notes += [denied_words(selection.best.model.shapes[i].called) for i in denied]
    if any(test.reversed for test in tests):
        notes.append(reversed_words(channels.force, channels.motion))
    words = verdict_words(verdict, depends_on, terms)
    finding = ComponentFinding(
        verdict, words, channels.motion, channels.force, terms, lags, depends_on, errors, force_std, held_out,
        tuple(notes),
    )  # fmt: skip
    return finding, best


def _divided(tests: Sequence[ComponentTest]) -> tuple[list[Part], Part]:
    """What is fitted, and what confirms it."""
    settled = [Part(test, test.known & (test.t >= SETTLING_SHARE * test.t[-1])) for test in tests]
    if len(tests) > 1:
        return settled[:-1], settled[-1]
    test, rows = settled[0]
    unseen = test.t > TRAINED_SHARE * test.t[-1]
    return [Part(test, rows & ~unseen)], Part(test, rows & unseen)


def _noise(test: ComponentTest) -> float:
    """Noise of the force, N: what is left of it beside a smooth signal, or, where it jumps, what most
    neighbouring samples differ by.
    """
    force = test.force[test.known]
    differing = fast_noise(force)
    return float(max(min(differing, smoothed(force).noise), 1e-12 * float(np.std(force))))


def _error(found: Fitted, unseen: Part) -> float:
    left = (unseen.test.force - found.force(unseen.test))[unseen.rows]
    return float(np.sqrt(np.mean(np.square(left))))


def _denied(best: Fitted, unseen: Part) -> list[int]:
    """Laws without which unseen data are predicted as well."""
    here, denied = _error(best, unseen), []
    for i, shape in enumerate(best.model.shapes):
        if shape.law is not None:
            others = (*best.model.shapes[:i], *best.model.shapes[i + 1 :])
            without = sized(replace(best.model, shapes=others), best.parts) if others else None
            if without is not None and _error(without, unseen) <= here:
                denied.append(i)
    return denied


def _verdict(errors: Errors) -> str:
    if errors.found <= AT_NOISE_RATIO * errors.noise:
        return "explained"
    return "improved" if errors.found < BETTER_RATIO * errors.plain else "unexplained"


def _depends_on(best: Fitted, terms: tuple[Term, ...]) -> tuple[str, ...]:
    """Motion and inputs from which the force follows."""
    if not terms:
        return ()
    of: set[str] = set(best.model.inputs)
    for shape in best.model.shapes:
        of |= set(shape.law.depends_on if shape.law else MOTION_OF[shape.kind])
    return tuple(name for name in ("x", "v", *best.model.lags) if name in of)


def _held_out(tests: Sequence[ComponentTest], unseen: Part) -> str:
    if len(tests) > 1:
        return unseen.test.name
    rows = np.flatnonzero(unseen.rows)
    return sampled_words(float(unseen.test.t[rows[0]]), float(unseen.test.t[rows[-1]]))
