"""What can be wrong with a link: samples late, uneven, lost, or stamped by another clock."""

from __future__ import annotations

from collections.abc import Mapping

from rthm_core.effects.base import Effect, EffectParameter, register

LONGEST = 60.0
"""Longest time beside a delay, s; a delay shorter than the spec's cannot be shorter by more than itself."""


class ExtraDelay(Effect):
    """Delay of either sign beside one of the spec; the words of a negative one say by how much earlier."""

    @classmethod
    def describe(cls, block: str, place: str, values: Mapping[str, float | str]) -> str:
        """Return the words with value and place filled in."""
        delay = cls._text("delay", values["delay"], block)
        said = super().describe(block, place, {"delay": delay.removeprefix("-")})
        return said.replace(" later ", " earlier ") if delay.startswith("-") else said


@register
class LinkExtraDelay(ExtraDelay):
    """Delay beside the link's tau; a negative one makes the link faster than its tau says."""

    kind = "extra_delay"
    blocks = ("link",)
    parameters = {
        "delay": EffectParameter(
            "s", "delay beside the link's tau, no less than -tau", minimum=-LONGEST, maximum=LONGEST
        )
    }
    equation = "due = stamp + tau + delay"
    words = "samples reach the receiver of {block} {delay} later than its delay says"


@register
class Jitter(Effect):
    """Random extra delay, drawn anew for every sample; it never makes a sample early."""

    kind = "jitter"
    blocks = ("link",)
    parameters = {
        "std": EffectParameter(
            "s", "standard deviation of the normal number behind it", minimum=0.0, maximum=LONGEST
        )
    }
    equation = "due = stamp + tau + |N(0, std)|"
    words = "the delay of {block} jitters: each sample is late by a random time of about {std}"


@register
class Loss(Effect):
    """Samples that never arrive."""

    kind = "loss"
    blocks = ("link",)
    parameters = {"fraction": EffectParameter("1", "share of samples lost", minimum=0.0, maximum=1.0)}
    equation = "P(sample lost) = fraction"
    words = "of the samples on {block}, a share of {fraction} is lost"


@register
class ClockOffset(Effect):
    """Sender and receiver disagree about the time, so the receiver keeps a sample too long or too short."""

    kind = "clock_offset"
    blocks = ("link",)
    parameters = {
        "offset": EffectParameter(
            "s",
            "sender's clock minus receiver's clock; + keeps samples longer",
            minimum=-LONGEST,
            maximum=LONGEST,
        )
    }
    equation = "due = max(stamp, stamp + tau + offset)"
    words = "the clocks at the two ends of {block} differ by {offset}"
