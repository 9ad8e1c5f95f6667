"""Hum of the mains in one channel: a steady narrow line that no motion of the plant makes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    HUM_AMPLITUDE_RATIO,
    HUM_FEWEST_NEIGHBOURS,
    HUM_FEWEST_PERIODS,
    HUM_MEANS_TAKEN_OFF,
    HUM_NEIGHBOUR_HZ,
    HUM_OWN_READINGS_SHARE,
    HUM_PERIODS_PER_SAMPLE,
    HUM_POWER_TO_MEDIAN,
    HUM_POWER_TO_NEXT,
    HUM_SHOWN_POWER_SHARE,
    HUM_SHOWN_SHARE,
    HUM_TO_NATURAL_FREQUENCY,
    MAINS_HZ,
    MAINS_WANDER_HZ,
)
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.smooth import channel_at, good_length
from rthm_analysis.diagnosis.faults.stretches import held_commands, with_column
from rthm_analysis.diagnosis.replay.evidence import MOTION, UNIT_OF, Channel, Evidence
from rthm_analysis.diagnosis.replay.updates import readings_only
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.diagnosis.signals import filled
from rthm_core.substructure import natural_frequencies

if TYPE_CHECKING:
    from rthm_core.compiled import Flags, Floats
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Line:
    """A line of a channel: frequency (Hz) as it is in the samples, that of the mains, amplitude."""

    frequency: float
    mains: float
    amplitude: float


class Spectrum(NamedTuple):
    """Frequencies, Hz, of a spectrum, and the power there."""

    frequencies: Floats
    power: Floats


def find_hum(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Find hum in each channel and take it out, its slow changes of amplitude included."""
    natural = _natural(spec)
    faults: list[Fault] = []
    seen = readings_only(evidence)
    for column, channel in enumerate(seen.channels):
        values = seen.measured[:, column]
        rows = _rows(values)
        time = seen.time[rows]
        step = float(np.median(np.diff(time)))
        spectrum: Spectrum | None = None
        for mains in MAINS_HZ:
            aliased = _aliased(mains, 1.0 / step)
            if (
                step * mains > HUM_PERIODS_PER_SAMPLE
                or aliased < HUM_TO_NATURAL_FREQUENCY * natural
                or time[-1] * aliased < HUM_FEWEST_PERIODS
            ):
                continue
            spectrum = spectrum or _spectrum(filled(values)[rows], time)
            line = _line(time, filled(values)[rows], spectrum, aliased, mains)
            if line is None or _is_motion(seen, column, line):
                continue
            faults.append(_fault(channel, line))
            values = values.copy()
            values[rows] -= _wave(time, filled(values)[rows], line.frequency)
            evidence, spectrum = with_column(evidence, column, values), None
    return evidence, faults


def _rows(values: Floats) -> Flags:
    """Samples (s,) to look at: all but where most are no readings of their own."""
    known = np.isfinite(values)
    return known if known.mean() < HUM_OWN_READINGS_SHARE else np.ones_like(known)


def _natural(spec: Spec) -> float:
    """Highest natural frequency of the plant at its wires, Hz."""
    assert spec.plant is not None
    size = len(spec.plant.dofs)
    mass = np.reshape(spec.plant.mass, (size, size))
    stiffness = np.reshape(spec.plant.stiffness, (size, size)) + np.diag([sum(spec.k_tot)] * size)
    return float(natural_frequencies(mass, stiffness)[-1]) / (2.0 * np.pi)


def _aliased(frequency: float, rate: float) -> float:
    """Frequency that samples at a rate show instead."""
    folded = frequency % rate
    return min(folded, rate - folded)


def _line(time: Floats, values: Floats, spectrum: Spectrum, near: float, mains: float) -> Line | None:
    """Steady line of a signal near a frequency; None where nothing stands out."""
    frequencies, power = spectrum
    inside = np.abs(frequencies - near) <= MAINS_WANDER_HZ + 1.0 / time[-1]
    away = np.abs(frequencies - near)
    beside = (away <= HUM_NEIGHBOUR_HZ) & (away > 2.0 * MAINS_WANDER_HZ)
    if not inside.any() or np.count_nonzero(beside) < HUM_FEWEST_NEIGHBOURS:
        return None
    peak = int(np.flatnonzero(inside)[np.argmax(power[inside])])
    least = max(
        HUM_POWER_TO_MEDIAN * float(np.median(power[beside])),
        HUM_POWER_TO_NEXT * float(power[beside].max()),
        1e-300,
    )
    if power[peak] < least:
        return None
    frequency = _between(frequencies, power, peak)
    thirds = [_amplitude(t, v, frequency) for t, v in _thirds(time, values)]
    if not max(thirds) < HUM_AMPLITUDE_RATIO * min(thirds):
        return None
    return Line(frequency, mains, _amplitude(time, values, frequency))


def _spectrum(values: Floats, time: Floats) -> Spectrum:
    """Frequencies, Hz, and power through a window that keeps strong slow motion where it is."""
    step, size = float(time[-1]) / max(time.size - 1, 1), good_length(values.size)
    second = np.diff(values, 2, prepend=values[0], append=values[-1])
    spectrum = np.fft.rfft(second * np.blackman(values.size), size)
    frequencies = np.asarray(np.fft.rfftfreq(size, step), dtype=float)
    return Spectrum(frequencies, np.square(np.abs(spectrum)))


def _between(frequencies: Floats, power: Floats, peak: int) -> float:
    """Frequency of a peak, between the bins."""
    if not 0 < peak < power.size - 1:
        return float(frequencies[peak])
    low, top, high = np.log(np.maximum(power[peak - 1 : peak + 2], 1e-300))
    by = 0.5 * (low - high) / min(low - 2.0 * top + high, -1e-12)
    return float(frequencies[peak] + np.clip(by, -0.5, 0.5) * (frequencies[1] - frequencies[0]))


def _thirds(time: Floats, values: Floats) -> list[tuple[Floats, Floats]]:
    return list(zip(np.array_split(time, 3), np.array_split(values, 3), strict=True))


def _amplitude(time: Floats, values: Floats, frequency: float) -> float:
    """Amplitude of a wave in a signal, whose slow part a window keeps away."""
    window = np.blackman(values.size)
    moved = values - np.linspace(float(values[0]), float(values[-1]), values.size)
    return float(2.0 * np.abs(np.sum(moved * window * np.exp(-2j * np.pi * frequency * time))) / window.sum())


def _wave(time: Floats, values: Floats, frequency: float) -> Floats:
    """The wave itself, its amplitude and phase changing slowly: through a window as wide as a quarter."""
    turn = np.exp(-2j * np.pi * frequency * time)
    width = max(round(1.0 / frequency / max(float(time[1] - time[0]), 1e-12)), 1)
    waves = _basis(time) * turn.conj()[:, None]
    columns = np.hstack([waves.real, waves.imag])
    inner = slice(HUM_MEANS_TAKEN_OFF * width, -HUM_MEANS_TAKEN_OFF * width)
    fast = np.column_stack([_fast(one, width) for one in (*columns.T, values)])[inner]
    return np.asarray(columns @ np.linalg.lstsq(fast[:, :-1], fast[:, -1], rcond=None)[0])


def _fast(values: Floats, width: int) -> Floats:
    """What of a signal is no slower than a wave: a motion may be larger than it by thousands."""
    for _ in range(HUM_MEANS_TAKEN_OFF):
        values = values - _mean(values, width)
    return values


def _basis(time: Floats) -> Floats:
    """Parabolas: how an amplitude may change over a recording."""
    middle = 2.0 * time / float(time[-1]) - 1.0
    return np.column_stack([np.ones_like(time), middle, np.square(middle)])


def _mean(values: Floats, width: int) -> Floats:
    """Running mean over one period of the wave."""
    total = np.cumsum(np.concatenate([np.full(width, values[0]), values]))
    mean = (total[width:] - total[:-width]) / width
    return np.concatenate([mean[width // 2 :], np.full(width // 2, mean[-1])])


def _is_motion(evidence: Evidence, column: int, line: Line) -> bool:
    """Whether another channel shows what a motion with this line would make there."""
    channel, omega = evidence.channels[column], 2.0 * np.pi * line.frequency
    shows = [(evidence.load[:, i], 0.0) for i in range(evidence.load.shape[1])]
    if channel.family in MOTION:
        for rates, other in enumerate(MOTION, -MOTION.index(channel.family)):
            partner = channel_at(evidence, other, channel.place)
            if rates and partner is not None:
                shows.append((filled(evidence.measured[:, partner]), omega**rates))
    else:
        for i, one in enumerate(evidence.channels):
            if one.family in ("force", "motor") and one.family != channel.family:
                shows.append((filled(evidence.measured[:, i]), 0.0))
        if evidence.driven_by == "command":
            ratio = 1.0 if channel.family == "motor" else 0.0  # no motor goes further than its command
            shows += [(one, ratio) for one in held_commands(evidence).T]
    return any(_shows(signal, evidence.time, line, ratio) for signal, ratio in shows)


def _shows(signal: Floats, time: Floats, line: Line, ratio: float) -> bool:
    """Whether a signal has a line there: of the size that kinematics ask for, or (ratio 0) any that
    stands out.
    """
    if not np.any(signal):
        return False
    if ratio:
        return _amplitude(time, signal, line.frequency) > HUM_SHOWN_SHARE * ratio * line.amplitude
    frequencies, power = _spectrum(signal, time)
    inside = np.abs(frequencies - line.frequency) <= MAINS_WANDER_HZ
    beside = (np.abs(frequencies - line.frequency) <= HUM_NEIGHBOUR_HZ) & ~inside
    return bool(
        power[inside].max(initial=0.0)
        > HUM_SHOWN_POWER_SHARE * HUM_POWER_TO_MEDIAN * max(float(np.median(power[beside])), 1e-300)
    )


def _fault(channel: Channel, line: Line) -> Fault:
    aliased = (
        "" if abs(line.frequency - line.mains) < 1.0 else f" ({line.mains:.0f} Hz, as these samples show it)"
    )
    words = (
        f"{in_words(channel, first=True)} carries a hum of {line.amplitude:.3g} {UNIT_OF[channel.family]} at "
        f"{line.frequency:.2f} Hz{aliased} that no other channel shows. It was taken out for this diagnosis; "
        "check shielding and earth of this sensor."
    )
    return fault_of(channel, "hum", words, None, line.amplitude)
