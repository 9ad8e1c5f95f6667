"""What was found about a link, for a test engineer."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from rthm_analysis.diagnosis.numbers import number, percent
from rthm_analysis.diagnosis.result import Value
from rthm_core.effects import effect

if TYPE_CHECKING:
    from rthm_analysis.timing.host_stalls import HostStalls
    from rthm_core.effects.link import LinkEffect

RECEIVERS = {
    "tau1": "states of the plant on their way to the controller",
    "tau2": "states of the plant on their way to the numerical substructure",
    "tau3": "force references on their way to the controller",
    "tau4": "commands on their way to the motor",
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
    law = cast("type[LinkEffect]", effect(kind, f"link.{name}"))
    size = Value(abs(value.value), value.std, value.unit) if law.ways else value
    way = law.ways[value.value > 0.0] if law.ways else ""
    first = law.finding.format(samples=RECEIVERS[name], name=name, value=shown(size), way=way)
    seen = f"On the last third of the recording it removes {percent(max(share, 0.0))} of the squared error "
    seen += "in the age of the sample in use."
    text = f"{first} {seen} {law.against}"
    if law.changes != "delay":
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
