"""One concealed case: a test drawn at random, effects in it, its recording, and the truth."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from benchmarks.concealed.amounts import Scene
from benchmarks.concealed.bag import write_bag
from benchmarks.concealed.draw import draw_test
from benchmarks.concealed.kinds import make_effect
from benchmarks.concealed.loop import EXTRA_PLANT, EXTRA_WIRE, SEEN, TRUE, Recording
from benchmarks.concealed.simulate import run
from benchmarks.concealed.visibility import FLOOR, replayed, rms, visibility
from benchmarks.concealed.world import HybridTest

LOUD = 4.0  # an effect with a larger share of the force, over its size, is no concealed one
GROWTH = (1.0, 1.6, 2.5, 4.0)  # an effect that nobody could see is made larger
SIGNALS = ("x1", "v1", "u", "F")
RETUNED = {"plant": {"mass": 0.05, "damping": 1.0}}
UNSURE = {"plant": {"mass": 0.05, "damping": 0.5, "stiffness": 0.05}}
Kinds = tuple[tuple[str, str], ...]


@dataclass
class Case:
    """A bag, the nominal spec beside it, and what only the scorer may know."""

    bag: Path
    spec: Path
    truth: dict[str, Any]
    log: Recording

    def floor(self, signal: str, start: float, end: float) -> float:
        """Return the true model's error from `start` to `end` s, over the signal's standard deviation."""
        i = SIGNALS.index(signal)
        t = np.arange(len(self.log.plant)) * self.truth["spec"]["timing"]["td1"]
        part = (t >= start) & (t < end)
        seen, true = self.log.plant[part][:, SEEN][:, i], self.log.plant[part][:, TRUE][:, i]
        return float(rms(seen - true) / seen.std())


def spec_text(spec: dict[str, Any]) -> str:
    """Return a spec as the text of a ROS 2 parameter file."""
    return str(yaml.safe_dump({"/**": {"ros__parameters": spec}}, sort_keys=False, default_flow_style=None))


def make_case(
    seed: int,
    kinds: Kinds,
    size: float,
    folder: Path,
    retune: str = "",
    duration: float = 60.0,
    lateness: float = 0.0,
) -> Case:
    """Draw a test, conceal the effects and record it.

    Parameters
    ----------
    seed
        Of everything that is drawn.
    kinds
        Pairs of block and kind, as the contract names them; none for a test in which nothing is missing.
    size
        Share of the wire's force that each effect has, about; larger where that would not be seen.
    folder
        Gets ``bag/`` and ``spec.yaml``; the truth is not written.
    retune
        ``mass``, ``damping``: the nominal value is wrong (3 %, half) within its stated uncertainty;
        ``drawn``: mass, damping and stiffness of the plant are off by as much as their uncertainty says;
        empty: the nominal spec is exact.
    duration
        Seconds of recording.
    lateness
        Mean extra delay of every link in s, as of a machine that is busy; 0: exact stamps.
    """
    rng = np.random.default_rng(seed)
    while True:
        nominal, pilot = draw_test(
            rng, transmission=all(b != "wire" for b, _ in kinds) and rng.random() < 0.05
        )
        true = _retuned(nominal, retune, rng)
        for growth in GROWTH:
            test = _conceal(true, kinds, size * growth, Scene(true.spec, pilot, rng))
            log = run(test, duration, int(rng.integers(2**63)), lateness=lateness)
            if not np.abs(log.plant[:, TRUE][:, 0]).max() < 2.0 * np.abs(pilot[:, 0]).max() + 0.1:
                break
            share = _shares(log)
            if max(share.values()) > LOUD * size * growth + 0.05:
                break
            seen = _visibilities(test, nominal if retune in ("mass", "damping") else None, log)
            if min(seen.values(), default=FLOOR) >= FLOOR:
                return _write(
                    folder,
                    nominal,
                    test,
                    log,
                    {"seed": seed, "size": size * growth, "visibility": seen, "share": share},
                )


def _retuned(nominal: HybridTest, retune: str, rng: np.random.Generator) -> HybridTest:
    """Return the true test; writes the uncertainty into the nominal spec."""
    true = copy.deepcopy(nominal)
    factors = {
        "mass": {"mass": 1.0 + 0.03 * rng.choice([-1.0, 1.0])},
        "damping": {"damping": 2.0},
        "drawn": {
            k: 1.0 + std * float(np.clip(rng.normal(), -2.0, 2.0)) * (0.8 if k == "damping" else 1.0)
            for k, std in UNSURE["plant"].items()
        },
    }.get(retune, {})
    for key, factor in factors.items():
        true.spec["plant"][key] = [float(true.spec["plant"][key][0] * max(factor, 0.1))]
    if retune:
        nominal.spec["uncertainty"] = copy.deepcopy(UNSURE if retune == "drawn" else RETUNED)
    return true


def _conceal(true: HybridTest, kinds: Kinds, size: float, scene: Scene) -> HybridTest:
    test = copy.deepcopy(true)
    for i, (block, kind) in enumerate(kinds):
        test.spec.setdefault("effects", []).append(f"effect{i + 1}")
        test.spec[f"effect{i + 1}"] = make_effect(block, kind, size, scene)
    return test


def _visibilities(test: HybridTest, nominal: HybridTest | None, log: Recording) -> dict[str, float]:
    seen = {name: visibility(test, name, log) for name in test.spec.get("effects", [])}
    return seen | ({"retuned": replayed(nominal, log)} if nominal else {})


def _shares(log: Recording) -> dict[str, float]:
    """Force of the effects over the force of the wire, rms."""
    F = rms(log.plant[:, TRUE][:, 3])
    return {
        block: float(rms(log.plant[:, column]) / F)
        for block, column in (("plant", EXTRA_PLANT), ("wire", EXTRA_WIRE))
    }


def _write(
    folder: Path, nominal: HybridTest, test: HybridTest, log: Recording, truth: dict[str, Any]
) -> Case:
    folder.mkdir(parents=True, exist_ok=True)
    text = spec_text(nominal.spec)
    spec = folder / "spec.yaml"
    spec.write_text(text)
    start = np.random.default_rng(truth["seed"]).integers(1_600_000_000 * 10**9, 1_900_000_000 * 10**9)
    bag = write_bag(folder / "bag", log, test.spec, text, int(start))
    effects = [test.spec[name] for name in test.spec.get("effects", [])]
    loads = {
        "plant": test.sines1.tolist(),
        "numerical": test.sines2.tolist(),
        "ramp": [test.ramp1, test.ramp2],
    }
    more = {
        "effects": [{"block": e["block"], "kind": e["kind"]} for e in effects],
        "spec": test.spec,
        "nominal": nominal.spec,
        "loads": loads,
    }
    return Case(bag, spec, truth | more, log)
