"""One case of the open world: made by name and seed, told at the scale of its rig."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.concealed.bag import write_bag
from benchmarks.concealed.case import spec_text
from benchmarks.concealed.loop import SEEN, TRUE, W1, Recording
from benchmarks.concealed.open.bag import write_plain_bag
from benchmarks.concealed.open.catalogue import RECIPES, class_of
from benchmarks.concealed.open.draft import Draft
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.open.visibility import enough

ATTEMPTS = 60
GROWTH = 1.15  # of what is concealed, from one attempt to the next
LARGEST = 0.8  # m at the scale of the simulation: beyond, the test is taken as unstable


@dataclass
class OpenCase:
    """A bag, the spec beside it, and what only the scorer may know."""

    bag: Path
    spec: Path
    name: str
    hidden: list[Hidden]
    allowed: tuple[str, ...]
    tolerated: list[Hidden]
    truth: dict[str, Any]


def make_open_case(seed: int, name: str, folder: Path) -> OpenCase:
    """Make one case of the second part.

    Parameters
    ----------
    seed
        Of everything that is drawn.
    name
        One of `catalogue.RECIPES`.
    folder
        Gets ``bag/`` and ``spec.yaml``; the truth is not written.

    Raises
    ------
    RuntimeError
        When nothing was visible, or everything unstable, in `ATTEMPTS` attempts.
    """
    rng = np.random.default_rng(seed)
    for attempt in range(ATTEMPTS):
        draft = RECIPES[name](rng, GROWTH**attempt)
        log = draft.record(int(rng.integers(2**62)))
        if not _bounded(draft, log):
            continue
        before = log.plant[:, SEEN].copy()
        for edit in draft.edits:
            edit(log, draft)
        visible, seen = enough(draft, log, before)
        if visible:
            return _write(folder, name, seed, draft, log, seen)
    raise RuntimeError(f"{name}: nothing to be seen in {ATTEMPTS} attempts with seed {seed}.")


def _bounded(draft: Draft, log: Recording) -> bool:
    x1 = log.plant[:, TRUE][:, 0]
    least = 0.02 * np.abs(draft.setting.pilot[:, 0]).max()
    return bool(np.isfinite(log.plant).all() and least < np.abs(x1).max() < LARGEST)


def _in_time_of(time: float, one: Hidden) -> Hidden:
    """The same with its interval in seconds of the rig."""
    return (
        one
        if one.interval is None
        else replace(one, interval=(time * one.interval[0], time * one.interval[1]))
    )


def _write(folder: Path, name: str, seed: int, draft: Draft, log: Recording, seen: float) -> OpenCase:
    folder.mkdir(parents=True, exist_ok=True)
    scale, setting = draft.setting.scale, draft.setting
    told = scale.spec({"plant": draft.told["plant"]} if setting.plain else draft.told)
    if "uncertainty" in draft.told:
        told["uncertainty"] = draft.told["uncertainty"]
    text = spec_text(told)
    spec = folder / "spec.yaml"
    spec.write_text(text)
    start = int(np.random.default_rng(seed).integers(1_600_000_000 * 10**9, 1_900_000_000 * 10**9))
    real = scale.recording(log)
    stamps = start + scale.instants(round(draft.period * 1e9) * np.arange(len(log.plant)))
    if setting.plain:
        velocity = real.plant[:, 1] if setting.velocity else None
        load = real.plant[:, W1] if setting.loaded else None
        bag = write_plain_bag(folder / "bag", stamps, real.plant[:, 0], velocity, load, setting.drive, text)
    else:
        bag = write_bag(folder / "bag", real, scale.spec(draft.spec), text, start)
    truth = {
        "seed": seed, "name": name, "class": class_of(name), "rig": setting.rig, "plain": setting.plain,
        "samples": len(log.plant), "visibility": seen, "spec": scale.spec(draft.spec),
        "effects": draft.effects, "told": told, "loaded": setting.loaded, "velocity": setting.velocity,
        "time": scale.time, "noise": (draft.noise_size * scale.channels).tolist(),
    }  # fmt: skip
    hidden = [_in_time_of(scale.time, one) for one in draft.hidden]
    return OpenCase(bag, spec, name, hidden, draft.allowed, draft.tolerated, truth)
