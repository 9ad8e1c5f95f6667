"""One diagnosis (the JSON of `rthm diagnose`) against the truth of a case of the open world.

An entry of `physics` or `traces` is true when its block is one of a hidden thing's blocks and its kind, or
its kind's family, one that states it; an entry of `faults` when kind and block fit (what is wrong with a spec
may be told anywhere); one of `described` when the block fits and it depends on at least one of the true
variables. A hidden thing is stated by any of these, or by being retuned where it is a plain error of a
parameter.

wrong
    A confident answer (`match`, `retuned`, `explained`) that is not right: `match` where something is hidden;
    `retuned` where a hidden thing is no plain error of a parameter; `explained` with an entry that is not
    true, or without stating everything that is hidden; in a clean case, `explained` with an entry that is not
    true. Equivalent through the recorded channels, and so not wrong:

    - the gain or unit of the load of a plant alone, and its mass, damping and stiffness by one factor;
    - friction that differs with the direction, and dry friction beside a constant force;
    - a constant force on a plant alone, and an offset of its position or load;
    - another sign, unit or delay of position or load, where a plant alone has no other channel;
    - another test's spec of a plant alone, and other mass, damping, stiffness;
    - a longer or shorter tau4, and an extra delay (of either sign) of the motor;
    - a drop-out marked by NaN, or a velocity that is zero throughout, may stay unsaid.
invented
    An entry of `physics` or `traces` that is not true, under `improved` or `unexplained`.
alarm
    A clean case that is not a `match` (or `retuned`, where the parameters are off within what the spec says),
    or in which anything is named that is not there. Steps of a coarse sensor, and the hold of a slow one, are
    there and may be named.
block
    Under `improved` and `unexplained`, where something is hidden: one of its blocks is located.
values
    Parameters of rightly named kinds, and retuned entries, within two stated standard deviations of the true
    value, and how many there are. A free decay fixes mass, damping and stiffness up to one factor: not
    counted. Nor are equivalents of which the truth is another parameter.
"""

from __future__ import annotations

from typing import Any

from benchmarks.concealed.open.case import OpenCase
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.score import covers

CONFIDENT = ("match", "retuned", "explained")
NAMED = ("physics", "traces")
KEYS = (*NAMED, "faults", "described")


def open_score(case: OpenCase, said: dict[str, Any]) -> dict[str, Any]:
    """Return what is right about a diagnosis, in the words above."""
    verdict = said["verdict"]
    known = [*case.hidden, *case.tolerated]
    false = _false_entries(known, said)
    stated = [_stated(h, said) for h in case.hidden]
    result = {
        "verdict": verdict,
        "false": false,
        "stated": [sum(stated), len(stated)],
        "values": _values(known, said),
        "wrong": False,
        "invented": verdict not in CONFIDENT and any(key in NAMED for key, _ in false),
    }
    if case.hidden:
        right = verdict in case.allowed or (verdict != "match" and all(stated))
        if verdict == "retuned":
            right = all(h.retuned for h in case.hidden)
        result["wrong"] = verdict in CONFIDENT and (bool(false) or not right)
        result["right"] = verdict in CONFIDENT and not result["wrong"]
        if verdict not in CONFIDENT:
            result["block"] = any(b in h.blocks for h in case.hidden for b in said["located"])
        return result
    expected = verdict in ("match", *case.allowed) or (verdict == "explained" and case.tolerated)
    result["alarm"] = bool(false) or not expected
    result["wrong"] = verdict == "explained" and bool(result["alarm"])
    result["right"] = not result["alarm"]
    return result


def _false_entries(known: list[Hidden], said: dict[str, Any]) -> list[tuple[str, str]]:
    """Return every entry that states nothing of what is known: its key and words."""
    out = []
    for key in KEYS:
        for entry in said.get(key) or []:
            if not any(_states(h, key, entry) for h in known):
                out.append((key, f"{entry['block']} {entry.get('kind', 'described')}"))
    return out


def _states(hidden: Hidden, key: str, entry: dict[str, Any]) -> bool:
    if key in NAMED:
        return hidden.stated_by_kind(entry["block"], entry["kind"])
    if key == "faults":
        return hidden.stated_by_fault(entry["block"], entry["kind"])
    return hidden.stated_by_description(entry["block"], entry.get("depends_on") or [])


def _stated(hidden: Hidden, said: dict[str, Any]) -> bool:
    if any(_states(hidden, key, entry) for key in KEYS for entry in said.get(key) or []):
        return True
    return any(_entry(name) in hidden.retuned for name in said.get("retuned") or {})


def _entry(name: str) -> str:
    """Name of a spec entry without its index."""
    return name.split("[")[0]


def _values(known: list[Hidden], said: dict[str, Any]) -> list[int]:
    hits = []
    for hidden in known:
        for entry in said.get("physics") or []:
            if entry["kind"] == hidden.kind and entry["block"] in hidden.blocks:
                for key, value in (entry.get("parameters") or {}).items():
                    if key in hidden.parameters:
                        hits.append(covers(value, hidden.parameters[key], key))
        for name, value in (said.get("retuned") or {}).items():
            if _entry(name) in hidden.retuned and _entry(name) in hidden.parameters:
                hits.append(covers(value, hidden.parameters[_entry(name)], name))
    return [sum(h is True for h in hits), sum(h is not None for h in hits)]
