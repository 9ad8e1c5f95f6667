"""How a force that no kind of the library is was described, against the truth of its case.

variables
    The described forces together depend on the true variables and no others; on some of them where the truth
    is a force with a memory or of a mass, which the motion tells in several ways.
interval
    Where the force does not act all the time: beginning and end within 1 s (in the time of the simulation).
formula
    A formula is told.
twice, near
    The held-out error of the model with the described force is within 2 and 1.3 times the noise floor, in
    every recorded signal.
"""

from __future__ import annotations

from typing import Any

from benchmarks.concealed.open.case import OpenCase
from benchmarks.concealed.open.truth import Hidden

TWICE, NEAR = 2.0, 1.3
SECONDS = 1.0


def description(case: OpenCase, said: dict[str, Any]) -> dict[str, bool] | None:
    """Return what is right about a description; None where a kind of the library, or a fault, states it."""
    hidden = case.hidden
    named = [e for e in said["physics"] if any(h.stated_by_kind(e["block"], e["kind"]) for h in hidden)]
    faults = [
        e for e in said.get("faults") or [] if any(h.stated_by_fault(e["block"], e["kind"]) for h in hidden)
    ]
    if case.truth["class"] != "unlisted" or named or faults:
        return None
    told = said.get("described") or []
    floor = _floor(said)
    found = {
        "variables": all(_variables(h, told) for h in hidden),
        "formula": any(one.get("formula") for one in told),
        "twice": floor <= TWICE,
        "near": floor <= NEAR,
    }
    intervals = [_interval(h, told, case.truth["time"]) for h in hidden if h.interval is not None]
    return found | ({"interval": all(intervals)} if intervals else {})


def _variables(hidden: Hidden, told: list[dict[str, Any]]) -> bool:
    found = {name for one in told for name in one["depends_on"]}
    true = set(hidden.depends)
    return bool(found) and (found <= true if hidden.several else found == true)


def _interval(hidden: Hidden, told: list[dict[str, Any]], time: float) -> bool:
    assert hidden.interval is not None
    for one in told:
        interval = one.get("interval")
        pairs = zip(interval or (), hidden.interval, strict=False)
        if interval and all(abs(a - b) <= SECONDS * time for a, b in pairs):
            return True
    return False


def _floor(said: dict[str, Any]) -> float:
    """Return the largest held-out error over the noise floor."""
    ratios = [one["nrmse"]["explained"] / one["nrmse"]["noise_floor"] for one in said["fits"]]
    return max(ratios, default=float("inf"))
