"""Which cases a table has: every kind, size and member of a block in turn, seeds from one master seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from benchmarks.concealed.kinds import CATALOGUE, LINKS, PAIRS, SENSORS, SIZES, TRIPLES

UNSURE_SHARE = 0.2  # of the cases with one effect and without: plant parameters are uncertain and off


@dataclass(frozen=True)
class Item:
    """A case to make: `group` is effect, clean, pair, triple or retuned."""

    index: int
    group: str
    kinds: tuple[tuple[str, str], ...]
    size: float
    retune: str
    seed: int


def plan(master: int, bags: int, clean: int, pairs: int, triples: int, retuned: int) -> list[Item]:
    """Return all cases of a table in random order, so that an unfinished table is a fair sample."""
    rng = np.random.default_rng(master)
    rows: list[tuple[str, tuple[tuple[str, str], ...], float, str]] = []
    for i in range(bags):
        rows.append(("effect", (_member(i),), SIZES[(i + i // len(CATALOGUE)) % len(SIZES)], _unsure(rng)))
    for _ in range(clean):
        rows.append(("clean", (), SIZES[0], _unsure(rng)))
    for i in range(pairs):
        rows.append(("pair", PAIRS[i % len(PAIRS)], SIZES[1 + i // len(PAIRS) % 2], ""))
    for i in range(triples):
        rows.append(("triple", TRIPLES[i % len(TRIPLES)], SIZES[1 + i // len(TRIPLES) % 2], ""))
    for i in range(retuned):
        rows.append(("retuned", (), SIZES[0], ("mass", "damping")[i % 2]))
    seeds = rng.integers(2**62, size=len(rows))
    items = [Item(i, *row, int(seed)) for i, (row, seed) in enumerate(zip(rows, seeds, strict=True))]
    return [items[i] for i in rng.permutation(len(items))]


def _member(i: int) -> tuple[str, str]:
    """Return the i-th effect of an endless list that goes through all kinds, links and sensors."""
    block, kind = list(CATALOGUE)[i % len(CATALOGUE)]
    members = {"link.*": LINKS, "sensor.*": SENSORS}.get(block, (block,))
    return members[(i + i // len(CATALOGUE)) % len(members)], kind


def _unsure(rng: np.random.Generator) -> str:
    return "drawn" if rng.random() < UNSURE_SHARE else ""
