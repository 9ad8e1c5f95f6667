"""Times in the spec of the diagnosis that are not those of the test: faults of the spec, not of the loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.links.clocks import other_periods
from rthm_analysis.diagnosis.links.delays import other_delays
from rthm_analysis.diagnosis.result import Fault, Part, wrong_entry
from rthm_analysis.recording import Recording
from rthm_core.clock import NS
from rthm_core.spec import apply
from rthm_core.spec.numbers import numbers

if TYPE_CHECKING:
    from rthm_core.compiled import Integers
    from rthm_core.spec import Spec

CLOCKS = {
    "td1": ("plant", "plant/state has a sample every {value}"),
    "td2": ("numerical", "numerical/state has a state every {value}"),
    "td3": ("controller", "actuator/command has a command every {value}"),
    "td4": ("controller", "links/tau3 shows that the controller takes force references over {value}"),
}
"""Whose clock it is, and what the recording shows."""

COMPARE = "Compare the timing section of the spec with what the nodes were started with"


def wrong_times(recording: Recording, spec: Spec, spans: Integers) -> Part:
    """Find periods and delays of the spec that the recording denies; `changes` are those of the test.

    Parameters
    ----------
    spans : (k, 2) array
        When a host stalled, as from `host_stalls`.
    """
    allowed = numbers(spec)
    periods = {
        name: period
        for name, period in other_periods(recording, spec).items()
        if allowed[f"timing.{name}"].holds(period / NS)
    }
    changes = {f"timing.{name}": period / NS for name, period in periods.items()}
    clocked = apply(spec, changes) if changes else spec
    delays = other_delays(recording, clocked, spans)
    faults = [_wrong_period(recording, spec, name, period) for name, period in periods.items()]
    faults += [_wrong_delay(recording, spec, name, tau) for name, tau in delays.items()]
    return Part(
        faults=tuple(faults), changes=changes | {f"timing.{name}": tau / NS for name, tau in delays.items()}
    )


def _wrong_period(recording: Recording, spec: Spec, name: str, period: int) -> Fault:
    block, shown = CLOCKS[name]
    value = _milliseconds(period)
    if name == "td4":
        value = f"every {value}" if period else "as soon as they are due"
    known = recording.spec
    agrees = known is not None and known.timing is not None and known.timing.ns(name) == period
    also = ", as the spec in the recording says" if agrees else ""
    words = (
        f"The spec says timing.{name} = {_milliseconds(spec.loop().timing.ns(name))}, but "
        f"{shown.format(value=value)}{also}. {COMPARE}; all else here assumes the recorded period."
    )
    return wrong_entry(block, f"timing.{name}", words, period / NS)


def _wrong_delay(recording: Recording, spec: Spec, name: str, tau: int) -> Fault:
    uses = (
        f", and links/{name} shows that its samples were used after that time"
        if name in recording.links
        else f"; links/{name} is not recorded and cannot confirm it"
    )
    words = (
        f"The spec says timing.{name} = {_milliseconds(spec.loop().timing.ns(name))}, but the spec in the "
        f"recording, with which the test was run, says {_milliseconds(tau)}{uses}. {COMPARE}; all else here "
        "assumes the delay of the test."
    )
    return wrong_entry(f"link.{name}", f"timing.{name}", words, tau / NS)


def _milliseconds(ns: int) -> str:
    return f"{ns * 1e-6:.6g} ms"
