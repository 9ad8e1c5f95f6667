"""What is wrong with a recording: each returns what changes the recorded samples.

Columns are 0 to 3 for x1, v1, u, F and `W1` for the known load of a plant alone.
"""

from __future__ import annotations

import numpy as np
from benchmarks.concealed.loop import Recording
from benchmarks.concealed.open.draft import Draft, Edit


def gain(column: int, factor: float) -> Edit:
    """Multiply a channel: another sign or unit."""

    def edit(log: Recording, draft: Draft) -> None:
        log.plant[:, column] *= factor

    return edit


def swapped(one: int, other: int) -> Edit:
    """Exchange two channels, number by number at the rig's scale."""

    def edit(log: Recording, draft: Draft) -> None:
        scales = draft.setting.scale.channels
        ratio = scales[one] / scales[other]
        log.plant[:, [one, other]] = log.plant[:, [other, one]] * np.array([1.0 / ratio, ratio])

    return edit


def late(column: int, samples: int) -> Edit:
    """Delay a channel by so many samples; early where negative."""

    def edit(log: Recording, draft: Draft) -> None:
        rows = np.clip(np.arange(len(log.plant)) - samples, 0, len(log.plant) - 1)
        log.plant[:, column] = log.plant[rows, column]

    return edit


def spikes(column: int, count: int, size: float) -> Edit:
    """Replace single samples by ones that are `size` times the channel's rms off."""

    def edit(log: Recording, draft: Draft) -> None:
        at = draft.rng.choice(len(log.plant), count, replace=False)
        rms = np.sqrt(np.mean(log.plant[:, column] ** 2))
        off = draft.rng.choice([-1.0, 1.0], count) * draft.rng.uniform(0.5, 1.5, count)
        log.plant[at, column] += size * rms * off

    return edit


def stretches(column: int, count: int, share: float, fill: str) -> Edit:
    """Replace `count` stretches, `share` of the recording in all, by `fill`: last, zero or nan."""

    def edit(log: Recording, draft: Draft) -> None:
        n = len(log.plant)
        length = max(int(share * n / count), 3)
        for begin in draft.rng.integers(n // 20, n - length - 1, count):
            value = {"last": log.plant[begin - 1, column], "zero": 0.0, "nan": np.nan}[fill]
            log.plant[begin : begin + length, column] = value

    return edit


def hum(column: int, size: float, hertz: float = 50.0) -> Edit:
    """Add a tone of the mains, `size` times the channel's rms."""

    def edit(log: Recording, draft: Draft) -> None:
        t = np.arange(len(log.plant)) * draft.period * draft.setting.scale.time
        rms = np.sqrt(np.mean(log.plant[:, column] ** 2))
        log.plant[:, column] += size * rms * np.sin(2.0 * np.pi * hertz * t + draft.rng.uniform(0.0, 6.28))

    return edit


def clipped(column: int, share: float) -> Edit:
    """Cut a channel where its magnitude is largest for this share of the time."""

    def edit(log: Recording, draft: Draft) -> None:
        limit = np.quantile(np.abs(log.plant[:, column]), 1.0 - share)
        log.plant[:, column] = np.clip(log.plant[:, column], -limit, limit)

    return edit


def rectified(column: int) -> Edit:
    """Lose the sign of a channel."""

    def edit(log: Recording, draft: Draft) -> None:
        log.plant[:, column] = np.abs(log.plant[:, column])

    return edit


def constant(column: int, value: float) -> Edit:
    """Let a channel never change."""

    def edit(log: Recording, draft: Draft) -> None:
        log.plant[:, column] = value

    return edit


def repeated(column: int, times: int) -> Edit:
    """Let a sensor be slower than the recording: every sample stands `times` times."""

    def edit(log: Recording, draft: Draft) -> None:
        log.plant[:, column] = np.repeat(log.plant[::times, column], times)[: len(log.plant)]

    return edit


def interpolated(column: int, times: int) -> Edit:
    """Let straight lines stand between every `times`-th sample."""

    def edit(log: Recording, draft: Draft) -> None:
        n = np.arange(len(log.plant))
        log.plant[:, column] = np.interp(n, n[::times], log.plant[::times, column])

    return edit


def rounded(column: int, noises: float) -> Edit:
    """Round a channel to `noises` times its noise."""

    def edit(log: Recording, draft: Draft) -> None:
        step = noises * draft.noise_size[column]
        log.plant[:, column] = np.round(log.plant[:, column] / step) * step

    return edit
