"""What a driver tells: each thing once, when it is new."""

from __future__ import annotations

from collections.abc import Callable


class Teller:
    """Tells what is new.

    Parameters
    ----------
    log
        Takes a sentence.

    Attributes
    ----------
    last
        What was said last, but for its figures.
    """

    def __init__(self, log: Callable[[str], object]) -> None:
        self._log, self._device = log, ""
        self.last = ""

    def say(self, words: str) -> None:
        """Say it, unless it was said last; what stands before a colon tells one thing from another."""
        what = words.split(":")[0]
        if what != self.last:
            self.last = what
            self._log(words)

    def say_of_device(self, words: str) -> None:
        """Pass on what a device says of itself, when it changes."""
        if words != self._device:
            self._device = words
            self._log(f"the device: {words}")
