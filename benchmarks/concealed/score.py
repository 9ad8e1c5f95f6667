"""One diagnosis (the JSON of `rthm diagnose`) against the truth of its case."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.concealed.case import SIGNALS, Case
from benchmarks.concealed.kinds import family
from benchmarks.concealed.plan import Item

SIGMAS = 2.0  # a stated uncertainty covers the truth within so many standard deviations
Effect = tuple[str, str]


def canonical(effect: dict[str, Any]) -> Effect:
    """Block and kind, the same for effects that the contract calls the same through the recorded channels."""
    block, kind = effect["block"], effect["kind"]
    return ("motor", "extra_delay") if (block, kind) == ("link.tau4", "extra_delay") else (block, kind)


def score(
    item: Item, case: Case, said: dict[str, Any], oracle: dict[str, Any] | None = None
) -> dict[str, Any]:
    """Return what is right about a diagnosis.

    Parameters
    ----------
    item, case
        What was concealed.
    said
        The diagnosis.
    oracle
        A diagnosis of the same bag that was told the true kind, where there is one.

    Returns
    -------
    dict
        ``found`` (named, or told as a trace) and ``true`` effects; ``block``, ``family``, ``kind``: whether
        exactly the true ones were found; ``among``: whether each true kind is found or an alternative that is
        called indistinguishable; ``alarm``: whether something was named although nothing is missing;
        ``covered`` (retuned cases); ``values``: parameters of rightly named kinds within `SIGMAS` of their
        standard deviations, and all; ``held_out``: worst error on unseen data, over that of the true model or
        of the `oracle`.
    """
    true = sorted(canonical(e) for e in case.truth["effects"])
    found = sorted({canonical(e) for e in (*said["physics"], *said.get("traces", ()))})
    blocks = {b for b, _ in found} or {_known_as(b, true) for b in said["located"]}
    also = {canonical(e) for e in said.get("alternatives", []) if not e.get("distinguishable", True)}
    result = {
        "true": true,
        "found": found,
        "verdict": said["verdict"],
        "block": blocks == {b for b, _ in true},
        "family": {family(*e) for e in found} == {family(*e) for e in true},
        "kind": found == true,
        "both": set(true) <= set(found) or {family(*e) for e in true} <= {family(*e) for e in found},
        "among": set(true) <= set(found) | also,
        "held_out": held_out(case, said, oracle),
        "values": values(case, said),
    }
    if item.group == "clean":
        result["alarm"] = bool(found) or said["verdict"] not in (
            ("match", "retuned") if item.retune else ("match",)
        )
    if item.group == "retuned":
        result["covered"] = said["verdict"] == "retuned" and covered(case, said, item.retune)
    return result


def _known_as(block: str, true: list[Effect]) -> str:
    """Return the block's name; link.tau4 counts as the motor where that is where the delay is."""
    return "motor" if block == "link.tau4" and ("motor", "extra_delay") in true else block


def covered(case: Case, said: dict[str, Any], name: str) -> bool:
    """Whether a plant parameter's true value is within `SIGMAS` standard deviations of the one found."""
    true = case.truth["spec"]["plant"][name][0]
    entries = [e for key, e in said["retuned"].items() if key.split("[")[0] == f"plant.{name}"]
    return any(abs(e["value"] - true) <= SIGMAS * e["std"] for e in entries)


def values(case: Case, said: dict[str, Any]) -> list[int]:
    """Return how many parameters of rightly named kinds cover the true value, and of how many."""
    spec = case.truth["spec"]
    true = {canonical(spec[name]): spec[name] for name in spec.get("effects", [])}
    pairs = [
        (entry, true[canonical(e)][key], key)
        for e in said["physics"]
        if canonical(e) in true
        for key, entry in e.get("parameters", {}).items()
        if isinstance(true[canonical(e)].get(key), float)
    ]
    hits = [covers(*pair) for pair in pairs]
    return [sum(h is True for h in hits), sum(h is not None for h in hits)]


def covers(entry: dict[str, Any], true: float, key: str) -> bool | None:
    """Whether a stated value covers the true one; None where no standard deviation is stated."""
    value, std = entry.get("value"), entry.get("std")
    if value is None or not std:
        return None
    off = value - true
    if key == "phase":
        off = (off + np.pi) % (2.0 * np.pi) - np.pi
    return bool(abs(off) <= SIGMAS * std)


def held_out(case: Case, said: dict[str, Any], oracle: dict[str, Any] | None) -> float | None:
    """Return the largest ratio over all fits of a diagnosis; None when it has none."""
    ratios = []
    for i, fit in enumerate(said.get("fits", [])):
        reached = fit["nrmse"].get("explained")
        best = _best(case, fit, oracle, i)
        if reached is not None and best:
            ratios.append(reached / best)
    return max(ratios, default=None)


def _best(case: Case, fit: dict[str, Any], oracle: dict[str, Any] | None, i: int) -> float | None:
    """Return the error of a fit that knows the kind: the oracle's, else the noise under the true model."""
    if oracle is not None and i < len(oracle["fits"]):
        return oracle["fits"][i]["nrmse"].get("explained")
    if fit["signal"] in SIGNALS:
        return case.floor(fit["signal"], *fit["held_out"])
    return fit["nrmse"].get("noise_floor")
