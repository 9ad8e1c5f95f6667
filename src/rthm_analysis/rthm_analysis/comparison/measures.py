"""What the field measures of two signals: definitions, with their sources.

`wanted` is what should have been (the target, a reference), `got` what was; both (n,) at the same instants,
in the same unit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

POWER = 2
"""Exponent l of the weights of the frequency evaluation index."""

SMALLEST_AMPLITUDE = 1e-3
"""Amplitude over the largest one below which a frequency is left out: its weight is a millionth."""

DEFINITIONS = {
    "NRMS": ("root mean square of the difference, over that of the reference", "J4-J6 where of a dof"),
    "J1": (
        "delay with which the actuator follows, at the largest cross-correlation, between the samples",
        "Silva et al. 2020",
    ),
    "J2": ("root mean square of the tracking error, over that of the target", "Silva et al. 2020"),
    "J3": ("largest tracking error, over the largest target", "Silva et al. 2020"),
    "J4-J6": ("root mean square error of a dof, over that of the reference", "Silva et al. 2020"),
    "J7-J9": ("largest error of a dof, over the largest of the reference", "Silva et al. 2020"),
    "FEI": (
        "sum of Y_I/Y_O |Y_I|^2 over the sum of |Y_I|^2; amplitude 1/|FEI|, delay -arg(FEI)/(2 pi f_eq),"
        " + when late",
        "Guo et al. 2014",
    ),
    "TI": (
        "half the area in the plane of target and motion less that in the plane of motion and target, + when"
        " late",
        "Mercan and Ricles 2007",
    ),
    "energy error": ("E_err at the end, over the largest E_total", "contract, section 1; paper, (13), (14)"),
    "equivalent damping": (
        "damper between plant and ground that drains as much as a term: -E over the integral of v1^2 at the"
        " interface",
        "paper",
    ),
    "effective delay": (
        "of a link: mean age of its samples at their use; of a motor: from the stamp of a command to its"
        " motion, delay and time constants together",
        "rthm timing; rthm check-driver --measure",
    ),
}
"""What each measure is, and where it is from."""

SOURCES = (
    "Silva, Gomez, Maghareh, Dyke, Spencer 2020: Benchmark control problem for real-time hybrid simulation,"
    " Mech. Syst. Signal Process. 135, 106381",
    "Guo, Chen, Xu, Sanchez 2014: A frequency response analysis approach for quantitative assessment of"
    " actuator tracking for real-time hybrid simulation, Smart Mater. Struct. 23, 045042",
    "Mercan, Ricles 2007: Stability and accuracy analysis of outer loop dynamics in real-time pseudodynamic"
    " testing of SDOF systems, Earthquake Eng. Struct. Dyn. 36",
)
"""Where the definitions are from."""


def peak_error(wanted: Floats, got: Floats) -> float:
    """Largest error over the largest wanted value (J3, J7 to J9); NaN where nothing is wanted.

    Source: Silva et al. 2020.

    Examples
    --------
    >>> peak_error(np.array([0.0, 2.0, -4.0]), np.array([0.0, 3.0, -4.0]))
    0.25
    """
    largest = np.abs(wanted).max(initial=0.0)
    return float(np.abs(got - wanted).max(initial=0.0) / largest) if largest else np.nan


class Evaluation(NamedTuple):
    """What the frequency evaluation index says.

    Attributes
    ----------
    amplitude : float
        Of what was got over that of what was wanted.
    delay : float
        s, + where it was late.
    frequency : float
        f_eq, the mean frequency of what was wanted, Hz.
    """

    amplitude: float
    delay: float
    frequency: float

    def as_dict(self) -> dict[str, float]:
        """Keys of the JSON."""
        return self._asdict()


def frequency_evaluation(step: float, wanted: Floats, got: Floats) -> Evaluation:
    """Frequency evaluation index of evenly spaced samples, as amplitude and delay.

    ``FEI = sum(Y_I / Y_O |Y_I|^l) / sum |Y_I|^l`` with l = 2, ``A = 1 / |FEI|``,
    ``f_eq = sum(f |Y_I|^l) / sum |Y_I|^l`` and ``d = -arg(FEI) / (2 pi f_eq)``.

    The transform here is ``Y(f) = sum y(t) exp(+2 pi i f t)``: then Y_I / Y_O of a late output turns by
    ``-2 pi f d``, and d is + where it is late. Signals lose their mean and are tapered (Hann), as a record
    that ends elsewhere than it began is no whole number of periods.

    Parameters
    ----------
    step : float
        Distance of the samples, s.
    wanted, got : (n,) arrays
        I and O.

    Returns
    -------
    Evaluation
        NaN where one of them does not move.

    Notes
    -----
    Source: Guo et al. 2014.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 0.001)
    >>> found = frequency_evaluation(0.001, np.sin(6.0 * t), 0.8 * np.sin(6.0 * (t - 0.01)))
    >>> round(found.amplitude, 4), round(found.delay, 5)
    (0.8, 0.01)
    """
    taper = np.hanning(wanted.size)
    y_i, y_o = (np.conj(np.fft.rfft(taper * (y - y.mean())))[1:] for y in (wanted, got))
    size = np.abs(y_i)
    used = (size > SMALLEST_AMPLITUDE * size.max(initial=0.0)) & (np.abs(y_o) > 0.0)
    if not used.any():
        return Evaluation(np.nan, np.nan, np.nan)
    weight = size[used] ** POWER / np.sum(size[used] ** POWER)
    index = complex(np.sum(weight * y_i[used] / y_o[used]))
    frequency = float(weight @ np.fft.rfftfreq(wanted.size, step)[1:][used])
    return Evaluation(1.0 / abs(index), -float(np.angle(index)) / (2.0 * np.pi * frequency), frequency)


def tracking_indicator(wanted: Floats, got: Floats) -> float:
    """Tracking indicator at the end, in the square of the signals' unit; + where `got` was late.

    ``TI = (A - TA) / 2`` with A the area under the way (got, wanted) and TA that under (wanted, got), each
    from trapezoids. Every cycle of amplitude X that is late by the phase p adds ``pi X^2 sin p``.

    Source: Mercan and Ricles 2007.

    Examples
    --------
    >>> p = np.linspace(0.0, 2.0 * np.pi, 10001)
    >>> round(tracking_indicator(np.sin(p), np.sin(p - 0.1)), 4)
    0.3136
    """
    area = np.sum(0.5 * (wanted[1:] + wanted[:-1]) * np.diff(got))
    turned = np.sum(0.5 * (got[1:] + got[:-1]) * np.diff(wanted))
    return float(0.5 * (area - turned))
