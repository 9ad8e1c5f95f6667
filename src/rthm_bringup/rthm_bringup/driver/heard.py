"""What was heard of a driver: plain data, without ROS."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers

NO_NUMBER = -1


@dataclass(frozen=True)
class Sample:
    """One message of ``plant/state``.

    Attributes
    ----------
    stamp_ns, received_ns : int
        Its stamp, and the instant at which this host had it, ns of the wall clock.
    number : int
        How many its publisher had sent before; `NO_NUMBER` where the middleware does not say.
    names : tuple of str
    position, velocity, effort : sequences of float
    """

    stamp_ns: int
    received_ns: int
    number: int
    names: tuple[str, ...]
    position: Sequence[float]
    velocity: Sequence[float]
    effort: Sequence[float]


@dataclass(frozen=True)
class Publisher:
    """Who publishes ``plant/state``, and how."""

    node: str
    type_name: str
    reliable: bool


@dataclass(frozen=True)
class Commanded:
    """Commands that were sent: stamps (c,), ns, and motor positions u_d (c, m), m."""

    stamp_ns: Integers
    position: Floats


@dataclass(frozen=True)
class Heard:
    """All that was heard, in the order of arrival.

    Attributes
    ----------
    publishers : tuple of Publisher
    samples : tuple of Sample
    listens : bool
        Whether somebody subscribes to ``actuator/command``.
    commanded : Commanded or None
        What was sent there; None: nothing was to move.
    """

    publishers: tuple[Publisher, ...]
    samples: tuple[Sample, ...]
    listens: bool
    commanded: Commanded | None = None

    @property
    def stamp_ns(self) -> Integers:
        """Stamps (s,)."""
        return np.array([one.stamp_ns for one in self.samples], dtype=np.int64)

    @property
    def age(self) -> Floats:
        """Ages of the samples when they arrived (s,), s."""
        received = np.array([one.received_ns for one in self.samples], dtype=np.int64)
        return np.asarray((received - self.stamp_ns) * 1e-9)

    @property
    def number(self) -> Integers:
        """Numbers that the publisher gave to them (s,); where it gave none, their order of arrival."""
        given = np.array([one.number for one in self.samples], dtype=np.int64)
        return np.arange(given.size) if np.any(given == NO_NUMBER) else given - given[0]
