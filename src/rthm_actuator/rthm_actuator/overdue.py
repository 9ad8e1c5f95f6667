"""Supervision of what comes, or lasts, too long: heartbeats, commands at a limit, the age of data."""

from __future__ import annotations

from collections.abc import Sequence

from rthm_actuator.supervision import Broken
from rthm_core.clock import NS


class Pulse:
    """An operator's heartbeat: once it was heard it must go on.

    Parameters
    ----------
    limit
        Longest silence, ns.
    awaited
        Whether it must be there from the start.
    """

    def __init__(self, limit: int, awaited: bool = False) -> None:
        self._limit, self._last = limit, 0 if awaited else None
        self._well = True

    def beat(self, now: int, well: bool) -> None:
        """Note a beat, and whether it says that all is well."""
        self._last, self._well = now, self._well and well

    def look(self, now: int) -> Broken | None:
        """Judge it at `now`, ns after the start."""
        if not self._well:
            return Broken("heartbeat", None, None, "the operator's heartbeat says that the test must end")
        if self._last is None or now - self._last <= self._limit:
            return None
        silent, allowed = (now - self._last) / NS, self._limit / NS
        words = f"the operator's heartbeat has been silent for {silent:.3f} s"
        return Broken("heartbeat", silent, allowed, words)


class Hold:
    """Commands that are at a limit for too long.

    Parameters
    ----------
    limit
        How long, ns.
    """

    def __init__(self, limit: int) -> None:
        self._limit, self._since = limit, dict[str, int]()

    def look(self, at: int, touched: Sequence[str]) -> Broken | None:
        """Look at the names of the limits that changed the command at `at`."""
        self._since = {name: self._since.get(name, at) for name in touched}
        for name, since in self._since.items():
            if at - since > self._limit:
                seconds, allowed = (at - since) / NS, self._limit / NS
                words = f"the command has been at limits.{name} for {seconds:.3f} s"
                return Broken("hold", seconds, allowed, words)
        return None


class Age:
    """Age of what the controller uses from one input.

    Parameters
    ----------
    topic
        Name of the input.
    first
        When its first sample is due, ns: until then none is missing.
    stale, age
        How long no sample may come, and how old the one in use may be, ns; None: any time.
    bad
        Kinds of sensor that come with this input.
    """

    def __init__(
        self, topic: str, first: int, stale: int | None, age: int | None, bad: tuple[str, ...] = ()
    ) -> None:
        self._topic, self._stale, self._age, self._bad = topic, stale, age, bad
        self._taken = self._stamp = first
        self._why = ""

    def unread(self, why: str) -> None:
        """Note what is wrong with a message that could not be read, to be told when nothing is fresh."""
        self._why = f": {why}"

    def heard(self, stamp: int, now: int) -> Broken | None:
        """Look at the stamp of a sample that arrives at `now`, both ns after the start."""
        ahead = stamp - now
        if self._age is None or abs(ahead) <= self._age:
            self._why = ""
            return None
        if ahead < 0:
            self._why = f": the last one that came is stamped {-ahead / NS:.3f} s in the past"
            return None
        words = f"a sample of {self._topic} is stamped {ahead / NS:.3f} s in the future"
        return Broken("age", -ahead / NS, self._age / NS, words)

    def used(self, stamp: int, now: int) -> None:
        """Note that a sample of this stamp is in use since `now`."""
        self._stamp, self._taken = max(stamp, self._stamp), now

    def look(self, now: int) -> Broken | None:
        """Judge what is in use at `now`, ns after the start."""
        old, silent = now - self._stamp, now - self._taken
        if self._stale is not None and (silent > self._stale or self._outlived(old, silent)):
            seconds = max(old, silent) / NS
            words = f"{self._topic} has had no fresh sample for {seconds:.3f} s{self._why}"
            return Broken("stale", seconds, self._stale / NS, words, self._bad)
        if self._age is not None and old > self._age:
            words = f"{self._topic} is {old / NS:.3f} s old where it is used, allowed is {self._age / NS:g} s"
            return Broken("age", old / NS, self._age / NS, words, self._bad)
        return None

    def _outlived(self, old: int, silent: int) -> bool:
        """Whether a sample that came in time has become too old since, where both limits are the same."""
        return self._age == self._stale and old > (self._stale or 0) and 2 * silent > old
