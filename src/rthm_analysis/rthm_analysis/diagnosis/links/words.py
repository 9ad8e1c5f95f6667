"""What was found about a link, for a test engineer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.numbers import number, percent
from rthm_analysis.diagnosis.result import Value

if TYPE_CHECKING:
    from rthm_analysis.timing.host_stalls import HostStalls

RECEIVERS = {
    "tau1": "states of the plant on their way to the controller",
    "tau2": "states of the plant on their way to the numerical substructure",
    "tau3": "force references on their way to the controller",
    "tau4": "commands on their way to the motor",
}

SENTENCES = {
    "extra_delay": "The {samples} (link {name}) arrive {value} {way} than the spec says, every one of them.",
    "jitter": "The {samples} (link {name}) are late by a random time, drawn anew for each: the size of "
    "a normal number with a standard deviation of {value}.",
    "loss": "Of the {samples} (link {name}), {value} never arrive; the receiver goes on with the one before.",
    "clock_offset": "The clocks at the two ends of the link {name} differ: to the receiver, the {samples} "
    "have stamps that are {value} {way}.",
}

WAYS = {"extra_delay": ("earlier", "later"), "clock_offset": ("behind", "ahead")}
"""Kinds of either sign, and which way a negative and a positive value goes."""

ELSE = {
    "extra_delay": "It is not a difference between the clocks: the receiver reports the sender's own stamps.",
    "jitter": "It is not a busy host: that makes few samples late, and some very late, which fits worse.",
    "loss": "The samples are not merely late: then they would be used afterwards, or be missed most where "
    "they have least time to spare; this fits worse.",
    "clock_offset": "A mere delay would not change the stamps.",
}

MOTOR_AS_WELL = " In motor position and force it is the same as a delay within the motor."
ADVICE = (
    " Compare timing.{name} in the spec with the delay that the receiving node was started with, and with "
    "what the transport takes."
)


def shown(value: Value) -> str:
    """Return value and standard deviation in readable units."""
    if value.unit == "1":
        return f"{number(100.0 * value.value, 100.0 * value.std, '%')}"
    return number(value.value, value.std, value.unit)


def sentence(name: str, kind: str, value: Value, share: float) -> str:
    """What was found: what, where, how big, how sure, what else it could be, and what to look at.

    Parameters
    ----------
    share : float
        Part of the squared error in the age of the samples, on unseen data, that it removes.
    """
    either = kind in WAYS
    size = Value(abs(value.value), value.std, value.unit) if either else value
    way = WAYS[kind][value.value > 0.0] if either else ""
    first = SENTENCES[kind].format(samples=RECEIVERS[name], name=name, value=shown(size), way=way)
    seen = f"On the last third of the recording it removes {percent(max(share, 0.0))} of the squared error "
    seen += "in the age of the sample in use."
    text = f"{first} {seen} {ELSE[kind]}"
    if kind != "extra_delay":
        return text
    return text + (MOTOR_AS_WELL if name == "tau4" else "") + ADVICE.format(name=name)


def stall_words(stalls: HostStalls) -> tuple[str, ...]:
    """Stalls of a host."""
    if not stalls.count:
        return ()
    share, longest = 100.0 * stalls.share, 1e3 * stalls.longest
    return (
        f"a host stalled {stalls.count} times, for {share:.1f} % of the test and up to "
        f"{longest:.3g} ms, as the times of sending show; samples that were on their way then are left out.",
    )


def lateness(name: str, late: float) -> str:
    """A machine that is a little late."""
    return (
        f"link.{name}: samples come {1e6 * late:.0f} us late on average, as they do on a busy machine; "
        "that is scheduling and no fault of the link."
    )
