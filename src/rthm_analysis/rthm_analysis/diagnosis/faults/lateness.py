"""Channels that come late or early by a constant time, and how that is told from a sensor's lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    DELAY_CHI2,
    DELAY_GAIN_OVER_LAG,
    DELAY_LEFT_SHARE,
    LATENESS_COHERENCE,
    LATENESS_FEWEST_FREQUENCIES,
    LATENESS_LEAST_SAMPLES,
    LATENESS_STEPS,
    LONGEST_LATENESS,
    SAMPLED_GAIN_STD,
)
from rthm_analysis.diagnosis.faults.spectra import spectra

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Late:
    """A constant delay of one signal after another, s, with its standard deviation."""

    delay: float
    std: float


@dataclass(frozen=True)
class Response:
    """How a signal follows another one, at the frequencies where it does.

    Attributes
    ----------
    omega : (f,) array
        rad/s.
    value : (f,) array
        Complex ratio of signal and reference.
    weight : (f,) array
        One over the squared error of `value`.
    """

    omega: Floats
    value: np.ndarray
    weight: Floats

    def left(self, shapes: np.ndarray) -> Floats:
        """Weighted squares that each shape (g, f) leaves at its best real gain."""
        along = np.real(shapes.conj() * self.value) @ self.weight
        size = np.square(np.abs(shapes)) @ self.weight
        total = float(np.square(np.abs(self.value)) @ self.weight)
        return np.asarray(total - np.square(along) / size)

    def slight(self) -> tuple[float, float]:
        """Weighted squares that a gain and a slight shift in time leave, and that shift, s."""
        basis = np.concatenate([np.ones_like(self.omega), np.zeros_like(self.omega)])
        turned = np.concatenate([np.zeros_like(self.omega), -self.omega])
        root = np.sqrt(np.tile(self.weight, 2))
        wanted = root * np.concatenate([self.value.real, self.value.imag])
        columns = root[:, None] * np.column_stack([basis, turned])
        found = np.linalg.lstsq(columns, wanted, rcond=None)[0]
        return float(np.sum(np.square(wanted - columns @ found))), float(found[1] / found[0])


def late(reference: Floats, signal: Floats, step: float, *, rate: int = 0) -> Late | None:
    """Delay of `signal` after `reference`, both (s,), of any gain; None where there is none, or it is a lag.

    With a `rate` the signal is compared with the first or second derivative of the reference. A delay
    turns phases in proportion to the frequency and leaves amplitudes; a first-order lag, of the one
    or of the other, loses amplitude with the frequency. Both are tried in time, so that strong lines do
    not leak
    into the comparison.
    """
    known = reference
    for _ in range(rate):
        known = np.gradient(known, step)
    first = _response(known, signal, step, rate)
    if first is None:
        return None
    delays = np.arange(-LONGEST_LATENESS, LONGEST_LATENESS, 0.5 * step)
    costs = first.left(np.exp(-1j * np.outer(delays, first.omega)))
    best = int(np.argmin(costs))
    about = float(delays[best])
    none = float(first.left(np.ones((1, first.omega.size)))[0])
    if not 0 < best < delays.size - 1 or abs(about) < step or none < DELAY_GAIN_OVER_LAG + costs[best]:
        return None
    moved = _aligned(known, signal, about, step, rate)
    if moved is None:
        return None
    delay, left, response = moved
    std = float(1.0 / np.sqrt(response.weight @ np.square(response.omega * np.abs(response.value))))
    fits = left < min(DELAY_LEFT_SHARE * none, DELAY_CHI2 * response.omega.size)
    clear = fits and left + DELAY_GAIN_OVER_LAG < _left_by_lag(first, known, signal, step, rate)
    return Late(delay, std) if clear and abs(delay) > LATENESS_LEAST_SAMPLES * step else None


def _aligned(
    known: Floats, signal: Floats, about: float, step: float, rate: int
) -> tuple[float, float, Response] | None:
    """Delay, what it leaves, and the response that is left, after a few steps towards the best delay."""
    at = np.arange(signal.size) * step
    found = None
    for _ in range(LATENESS_STEPS):
        response = _response(known, np.interp(at + about, at, signal), step, rate)
        if response is None:
            break
        left, more = response.slight()
        about += more
        found = about, left, response
        if abs(more) < 0.1 * step:
            break
    return found


def _response(reference: Floats, signal: Floats, step: float, rate: int) -> Response | None:
    """How a signal follows another; None where they have too few frequencies in common."""
    seen = spectra(np.column_stack([reference, signal]), step)
    kept = seen.coherence(0, 1) > LATENESS_COHERENCE
    if np.count_nonzero(kept) < LATENESS_FEWEST_FREQUENCIES:
        return None
    omega, coherence = seen.omega[kept], seen.coherence(0, 1)[kept]
    value = seen.cross[kept, 0, 1] / seen.cross[kept, 0, 0].real
    if rate:  # what differences of samples lose
        value = value * (np.sin(omega * step) / (omega * step)) ** rate
    sampling = (
        SAMPLED_GAIN_STD + np.square(omega * step) / 8.0
    )  # the latter is what straight lines between samples lose
    share = 0.5 * (1.0 - coherence) / (coherence * seen.parts) + (1.0 - coherence) ** 2 + np.square(sampling)
    return Response(omega, value, 1.0 / (share * np.abs(value) ** 2))


def _left_by_lag(first: Response, known: Floats, signal: Floats, step: float, rate: int) -> float:
    """What is left where the signal lags behind the reference, or this behind the signal."""
    lags = np.geomspace(0.2 * step, 2.0 * LONGEST_LATENESS, 120)
    shapes = 1.0 / (1.0 + 1j * np.outer(lags, first.omega))
    behind, before = first.left(shapes), first.left(1.0 / shapes)
    late_one = bool(behind.min() < before.min())
    constant, best = float(lags[np.argmin(behind if late_one else before)]), np.inf
    for _ in range(LATENESS_STEPS):
        one = _lagging(known, constant, step) if late_one else known
        other = signal if late_one else _lagging(signal, constant, step)
        response = _response(one, other, step, rate)
        if response is None:
            break
        left, more = response.slight()
        best, constant = min(best, left), constant + (more if late_one else -more)
        if abs(more) < 0.1 * step or constant <= 0.0:
            break
    return best


def _lagging(values: Floats, constant: float, step: float) -> Floats:
    """A signal behind a first-order lag, s."""
    more = int(10.0 * constant / step) + 10
    ramp = np.linspace(float(values[-1]), float(values[0]), more)
    size = values.size + more
    omega = 2.0 * np.pi * np.fft.rfftfreq(size, step)
    spectrum = np.fft.rfft(np.concatenate([values, ramp])) / (1.0 + 1j * omega * constant)
    return np.asarray(np.fft.irfft(spectrum, size)[: values.size])
