"""One owner of a topic: a second publisher is noticed by its endpoint on the graph, and in the samples.

The middleware numbers the samples of each publisher, one after another. Samples of two publishers that arrive
on one topic are therefore out of step: a number comes again or goes back, or runs ahead of what the publisher
can have sent since its last stamp.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

LIMIT = "owner"
"""Name of the limit that a second publisher breaks."""

UNNUMBERED = 2**63
"""A middleware that does not number samples gives a number from here on."""

SLACK = 20
"""Samples that a publisher may send at once beyond its rate, as after a stall of its host."""


def second_owner(publishers: Mapping[str, Sequence[str]]) -> str:
    """Say which topic has more than one publisher; empty: none has.

    Parameters
    ----------
    publishers
        Full names of the nodes that publish each topic.
    """
    for topic, names in sorted(publishers.items()):
        if len(names) > 1:
            return f"{topic} has {len(names)} publishers, {' and '.join(sorted(names))}, but must have one"
    return ""


class Ownership:
    """Follows the numbers of the samples of one topic.

    Parameters
    ----------
    spacing
        Mean distance of the stamps of samples at the highest rate of their publisher, ns; 0: not known.

    Attributes
    ----------
    words
        Why not all samples can be of one publisher; empty while they can.
    """

    def __init__(self, spacing: int = 0) -> None:
        self.words = ""
        self._spacing = spacing
        self._number: int | None = None
        self._stamp = 0

    def accept(self, number: int, stamp: int) -> bool:
        """Take notice of a sample; whether the publisher of all before it can have sent it.

        Parameters
        ----------
        number
            The publisher's number of the sample.
        stamp
            Its stamp, ns.
        """
        if number >= UNNUMBERED:
            return True
        if self._number is not None and not self._follows(number, stamp):
            self.words = self.words or f"sample {number} came after {self._number}, of another publisher"
            return False
        self._number, self._stamp = number, stamp
        return True

    def _follows(self, number: int, stamp: int) -> bool:
        assert self._number is not None
        steps = number - self._number
        if steps <= 0 or not self._spacing:
            return steps > 0
        return steps <= SLACK + 2 * max(stamp - self._stamp, 0) // self._spacing
