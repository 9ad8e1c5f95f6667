"""A planned test in words."""

from __future__ import annotations

from collections.abc import Sequence

from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.experiment.planning import Planned
from rthm_analysis.diagnosis.experiment.trials import Trial
from rthm_analysis.diagnosis.numbers import bare
from rthm_core.spec import ConstantLoad, HarmonicLoad, LoadSpec, MultisineLoad, Spec


def listed(names: Sequence[str]) -> str:
    """``a``, ``a from b``, ``a, b and c from each other``."""
    if len(names) == 2:
        return f"{names[0]} from {names[1]}"
    return f"{enumerated(names)} from each other"


def input_words(trial: Trial, nominal: Spec) -> str:
    """The input of a trial: ``a harmonic load of 0.8 N at 1.9 rad/s on x1, from rest``."""
    loads = [_load_words(one) for one in trial.loads.values() if one.kind != "none"]
    if loads:
        return f"{enumerated(loads)}, from rest"
    assert nominal.plant is not None
    starts = [
        f"{dof} = {trial.start * x:.3g} m"
        for dof, x in zip(nominal.plant.dofs, nominal.plant.initial_position, strict=True)
        if x
    ]
    return (
        f"a release from {' and '.join(starts)}"
        if starts
        else f"a start at {trial.start:.3g} times the speed"
    )


def _load_words(section: LoadSpec) -> str:
    if isinstance(section, HarmonicLoad):
        return f"a harmonic load of {section.amplitude:g} N at {section.frequency:g} rad/s on {section.dof}"
    if isinstance(section, MultisineLoad):
        band = f"from {section.low:g} to {section.high:g} rad/s"
        return f"a multisine load of {section.rms:g} N rms {band} on {section.dof}"
    if isinstance(section, ConstantLoad):
        return f"a constant load of {section.force:g} N on {section.dof}"
    return f"the load of a file on {section.dof}"


def what_to_run(planned: Planned, nominal: Spec) -> str:
    """Input and duration."""
    return f"{input_words(planned.trial, nominal)}, for {planned.duration:.3g} s"


def gain_words(planned: Planned, who: str) -> str:
    """How far predictions differ: ``the two predictions of x1 then differ by 14 times the noise``.

    `who` are the predictions, with ``{signal}`` where their signal is named.
    """
    return (
        f"{who.format(signal=planned.signal)} then differ by {times(planned.gain)} the noise "
        f"({times(planned.present)} in this recording)"
    )


def times(ratio: float) -> str:
    """``14 times``, with two digits."""
    return f"{bare(ratio, 2)} times"
