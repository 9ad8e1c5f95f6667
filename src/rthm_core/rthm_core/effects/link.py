"""What can be wrong with a link: samples late, uneven, lost, or stamped by another clock."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from rthm_core.effects.declaration import Effect, EffectParameter
from rthm_core.effects.registry import register

LONGEST_DELAY = 60.0
"""Longest time beside a delay, s; a delay shorter than the spec's cannot be shorter by more than itself."""


class LinkEffect(Effect):
    """What a link does beside its tau, of which one number says how much (`changes`).

    Attributes
    ----------
    finding
        What the uses of a link show, with ``{samples}``, ``{name}``, ``{value}`` and, of a kind with `ways`,
        ``{way}``.
    ways
        Which way a negative and a positive value goes, of a kind of either sign.
    against
        Why it is nothing else.
    """

    finding: ClassVar[str]
    ways: ClassVar[tuple[str, str] | None] = None
    against: ClassVar[str]


class ExtraDelay(Effect):
    """Delay of either sign beside one of the spec; the words of a negative one say by how much earlier."""

    changes = "delay"
    linear = True

    @classmethod
    def describe(cls, block: str, place: str, values: Mapping[str, float | str]) -> str:
        """Return the words with value and place filled in."""
        delay = cls._text("delay", values["delay"], block)
        said = super().describe(block, place, {"delay": delay.removeprefix("-")})
        return said.replace(" later ", " earlier ") if delay.startswith("-") else said


@register
class LinkExtraDelay(ExtraDelay, LinkEffect):
    """Delay beside the link's tau; a negative one makes the link faster than its tau says."""

    kind = "extra_delay"
    blocks = ("link",)
    parameters = {
        "delay": EffectParameter(
            "s",
            "delay beside the link's tau, no less than -tau",
            minimum=-LONGEST_DELAY,
            maximum=LONGEST_DELAY,
        )
    }
    equation = "due = stamp + tau + delay"
    words = "samples reach the receiver of {block} {delay} later than specified"
    experiment = (
        "Compare `rthm timing` of this recording with the spec's {name}: if the ages agree with "
        "the recording, correct the spec; if not, look for buffers between sender and receiver."
    )
    rank = 10
    finding = "The {samples} (link {name}) arrive {value} {way} than the spec says, every one of them."
    ways = ("earlier", "later")
    against = "It is not a difference between the clocks: the receiver reports the sender's own stamps."


@register
class Jitter(LinkEffect):
    """Random extra delay, drawn anew for every sample; it never makes a sample early."""

    kind = "jitter"
    blocks = ("link",)
    parameters = {
        "std": EffectParameter(
            "s", "standard deviation of the normal number behind it", minimum=0.0, maximum=LONGEST_DELAY
        )
    }
    equation = "due = stamp + tau + |N(0, std)|"
    words = "the delay of {block} jitters: each sample is late by a random time of about {std}"
    experiment = (
        "Record the same test with nothing else running on the receiver's host, and compare "
        "the p99 of {name} in `rthm timing`."
    )
    changes = "spread"
    rank = 20
    finding = (
        "The {samples} (link {name}) are late by a random time, drawn anew for each: the size of "
        "a normal number with a standard deviation of {value}."
    )
    against = "It is not a busy host: that makes few samples late, and some very late, which fits worse."


@register
class Loss(LinkEffect):
    """Samples that never arrive."""

    kind = "loss"
    blocks = ("link",)
    parameters = {"fraction": EffectParameter("1", "share of samples lost", minimum=0.0, maximum=1.0)}
    equation = "P(sample lost) = fraction"
    words = "of the samples on {block}, a share of {fraction} is lost"
    experiment = (
        "Count what is sent and what arrives of {name} (`rthm timing`, lost), first with both ends on "
        "one host: that tells the network from the programs."
    )
    changes = "lost"
    rank = 30
    finding = (
        "Of the {samples} (link {name}), {value} never arrive; the receiver goes on with the one before."
    )
    against = (
        "The samples are not merely late: then they would be used afterwards, or be missed most where "
        "they have least time to spare; this fits worse."
    )


@register
class ClockOffset(LinkEffect):
    """Sender and receiver disagree about the time, so the receiver keeps a sample too long or too short."""

    kind = "clock_offset"
    blocks = ("link",)
    parameters = {
        "offset": EffectParameter(
            "s",
            "sender's clock minus receiver's clock; + keeps samples longer",
            minimum=-LONGEST_DELAY,
            maximum=LONGEST_DELAY,
        )
    }
    equation = "due = max(stamp, stamp + tau + offset)"
    words = "the clocks at the two ends of {block} differ by {offset}"
    experiment = (
        "Compare the clocks of the two hosts of {name} (`chronyc tracking`), "
        "and record again once they are synchronised."
    )
    changes = "stamps"
    linear = True
    rank = 40
    finding = (
        "The clocks at the two ends of the link {name} differ: to the receiver, the {samples} "
        "have stamps that are {value} {way}."
    )
    ways = ("behind", "ahead")
    against = "A mere delay would not change the stamps."
