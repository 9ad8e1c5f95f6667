"""Why a run cannot go on, told by whoever notices; ROS is not needed to catch it."""

from __future__ import annotations

from rthm_core import events


class StoppedError(Exception):
    """The run cannot go on; the message says why in one sentence.

    Attributes
    ----------
    node : str or None
        Whose fault it is.
    """

    def __init__(self, sentence: str, node: str | None = None) -> None:
        super().__init__(sentence)
        self.node = node


class RefusedError(StoppedError):
    """A node refused a transition."""


class UnconnectedError(StoppedError):
    """Some connections were not made in time."""


class AbortedError(Exception):
    """The test was aborted.

    Attributes
    ----------
    abort : Abort
        Why.
    """

    def __init__(self, abort: events.Abort) -> None:
        super().__init__(abort.words)
        self.abort = abort
