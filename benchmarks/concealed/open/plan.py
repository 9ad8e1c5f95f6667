"""Which cases the second part has: classes by their shares, names in turn, seeds from one master seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from benchmarks.concealed.open.catalogue import CLASSES

SHARES = {"unlisted": 0.50, "spoiled": 0.07, "parameters": 0.05, "listed": 0.05, "clean": 0.33}


@dataclass(frozen=True)
class OpenItem:
    """A case to make."""

    index: int
    group: str
    name: str
    seed: int


def open_plan(master: int, cases: int) -> list[OpenItem]:
    """Return all cases in random order, so that an unfinished table is a fair sample."""
    rng = np.random.default_rng(master)
    counts = {group: round(share * cases) for group, share in SHARES.items()}
    counts["clean"] = cases - sum(n for group, n in counts.items() if group != "clean")
    rows = []
    for group, count in counts.items():
        names = rng.permutation(list(CLASSES[group]))
        rows += [(group, str(names[i % len(names)])) for i in range(count)]
    seeds = rng.integers(2**62, size=len(rows))
    items = [OpenItem(i, *row, int(seed)) for i, (row, seed) in enumerate(zip(rows, seeds, strict=True))]
    return [items[i] for i in rng.permutation(len(items))]
