"""Links: literal queues that hold every sample until its delay is over.

The samples of a link are rows of what its sender recorded, so a larger index is a newer sample. A newer
sample replaces an older one; an older one that arrives after a newer one is dropped.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

NEVER = np.iinfo(np.int64).max


class Link(NamedTuple):
    """A queue. All times are integer ns."""

    delay: int  # tau
    late: np.ndarray  # extra delay of each sample
    lost: np.ndarray  # whether each sample is lost
    due: np.ndarray  # when each sample arrives; NEVER once it has
    span: np.ndarray  # oldest sample that may be on its way, samples sent, newest sample delivered (-1: none)


def make_link(delay: int, late: np.ndarray, lost: np.ndarray) -> Link:
    """Empty link for as many samples as `late` has rows."""
    return Link(delay, late, lost, np.full(len(late), NEVER), np.array([0, 0, -1]))


@njit
def send(t: int, link: Link) -> None:
    """Put the sender's next sample on its way."""
    i = link.span[1]
    if not link.lost[i]:
        link.due[i] = t + link.delay + link.late[i]
    link.span[1] = i + 1


@njit
def next_due(link: Link) -> int:
    """Instant of the next arrival."""
    soonest = NEVER
    for i in range(link.span[0], link.span[1]):
        soonest = min(soonest, link.due[i])
    return soonest


@njit
def deliver(t: int, link: Link) -> bool:
    """Take in what is due at t; whether that is newer than what was there."""
    before = link.span[2]
    for i in range(link.span[0], link.span[1]):
        if link.due[i] <= t:
            link.due[i] = NEVER
            link.span[2] = max(link.span[2], i)
    while link.span[0] < link.span[1] and link.due[link.span[0]] == NEVER:
        link.span[0] += 1
    return link.span[2] > before
