"""Fits weighed by the colour of the noise, where it is noise that has the colour."""

from __future__ import annotations

from functools import reduce

from rthm_analysis.diagnosis.criteria.noise import OTHER_WAY_CHI2_RATIO
from rthm_analysis.diagnosis.fitting.noise import Noise
from rthm_analysis.diagnosis.physical.beginning import Baseline, with_noise
from rthm_analysis.diagnosis.physical.colours import coloured
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.physical.plainer import plain_fit
from rthm_analysis.diagnosis.search.judging import reduced_chi2


def whitened(begun: list[Baseline]) -> list[Baseline]:
    """The same weighed by the colour of the noise, where no way of the loads leaves white noise, and no other
    values of mass, damping and stiffness do. A way that leaves far more than another
    is not that of the rig, and says nothing of the noise.
    """
    left = [reduced_chi2(one.fitting, one.retuned) for one in begun]
    near = [one for one, its in zip(begun, left, strict=True) if its <= OTHER_WAY_CHI2_RATIO * min(left)]
    noise = reduce(Noise.smaller, [coloured(one.fitting, one.retuned, one.noise) for one in near])
    noise = noise.not_shared(begun[0].noise)
    if noise.is_white:
        return begun
    again = [with_noise(one, noise) for one in begun]
    hidden = at_noise(again[0].fitting, again[0].retuned)
    return begun if hidden and _values_are_off(begun[0]) else again


def _values_are_off(begun: Baseline) -> bool:
    """Whether other values of mass, damping and stiffness leave white noise."""
    fitting = begun.fitting
    with fitting.based_on(fitting.base):
        return at_noise(fitting, plain_fit(fitting, begun))
