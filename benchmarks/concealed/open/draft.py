"""A case that is being made."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from benchmarks.concealed.amounts import Scene
from benchmarks.concealed.kinds import family, make_effect
from benchmarks.concealed.loads import GRID, tabulate
from benchmarks.concealed.loop import Recording
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.open.worlds import Setting, between, copied, draw_loop, draw_plain
from benchmarks.concealed.simulate import run
from benchmarks.concealed.world import CHANNELS, REFERENCE_NOISE, HybridTest

REFERENCE = np.array([REFERENCE_NOISE[c] for c in CHANNELS])
Noise = Callable[[np.random.Generator, int, float], np.ndarray]  # samples, period -> (n, 4) of size 1
Edit = Callable[[Recording, "Draft"], None]


def white(rng: np.random.Generator, n: int, period: float) -> np.ndarray:
    """White noise of all channels."""
    return rng.normal(size=(n, 4))


@dataclass
class Draft:
    """What is told, what is true, and what becomes of the recording; all at the scale of the simulation.

    Parameters
    ----------
    rng
        Of everything that is drawn.
    setting
        The test before anything is concealed in it.
    told
        Spec that goes with the bag.
    true
        Test that is recorded.
    noise_size
        Standard deviations of x1, v1, u, F.
    noise
        Makes the noise, of size 1.
    edits
        Change the recording after the test.
    hidden
        What is concealed; nothing in a clean case.
    allowed
        Further verdicts that are right.
    tolerated
        What is true and may be named, though nothing is missing.
    measure
        How visible it is: `force` on the plant, `effects`, `each` of several, `plant` (another one was
        told), `edit` (of the recording), `links`, `certain`.
    """

    rng: np.random.Generator
    setting: Setting
    told: dict[str, Any]
    true: HybridTest
    noise_size: np.ndarray
    boost: float = 1.0
    noise: Noise = white
    edits: list[Edit] = field(default_factory=list)
    hidden: list[Hidden] = field(default_factory=list)
    allowed: tuple[str, ...] = ()
    tolerated: list[Hidden] = field(default_factory=list)
    measure: str = "certain"
    effects: list[dict[str, Any]] = field(default_factory=list)

    @property
    def spec(self) -> dict[str, Any]:
        """Spec of the true test."""
        return self.true.spec

    @property
    def period(self) -> float:
        """Of the samples, s."""
        return float(self.spec["timing"]["td1"])

    @property
    def scene(self) -> Scene:
        """What parameters of effects are scaled by."""
        return Scene(self.spec, self.setting.pilot, self.rng)

    @property
    def known_scene(self) -> Scene:
        """The scene, with the known load at the samples of the pilot."""
        scene, test = self.scene, self.setting.test
        t = self.period * np.arange(len(scene.pilot))
        table = tabulate(test.sines1, test.ramp1, float(t[-1]) + 1.0)
        scene.known = np.interp(t, GRID * np.arange(len(table)), table[:, 0])
        return scene

    def size(self, low: float = 0.03, high: float = 0.3) -> float:
        """Draw how large an effect is, over the force of the wire or of the plant's spring."""
        return min(between(self.rng, low, high) * self.boost, 0.6)

    def conceal(self, effect: dict[str, Any]) -> None:
        """Let an effect act that is not told."""
        name = f"effect{len(self.effects) + 1}"
        self.effects.append(effect)
        self.spec.setdefault("effects", []).append(name)
        self.spec[name] = effect

    def conceal_kind(self, block: str, kind: str, size: float) -> None:
        """Let a kind of the library act, and note the truth; its parameters are told at the rig's scale."""
        effect = make_effect(block, kind, size, self.scene)
        self.conceal(effect)
        real = self.setting.scale.effect(effect)
        values = {k: v for k, v in real.items() if isinstance(v, float)}
        blocks = ("motor", "link.tau4") if (block, kind) == ("motor", "extra_delay") else (block,)
        self.hidden.append(
            Hidden(
                kind,
                blocks,
                families=(family(block, kind),),
                depends=("x", "v", "a", "t", "u", "command", "load"),
                parameters=values,
                kind=kind,
            )
        )

    def record(self, seed: int) -> Recording:
        """Run the true test; faults of the recording are still to come."""
        n = int(self.setting.duration / self.period) + 2
        rng = np.random.default_rng(seed)
        deviates = self.noise(rng, n, self.period) * (self.noise_size / REFERENCE)
        step = 4e-4 if self.setting.plain else 1e-4
        return run(self.true, self.setting.duration, seed, noise=deviates, step=step)


def open_draft(rng: np.random.Generator, setting: Setting, boost: float = 1.0) -> Draft:
    """Return a draft in which nothing is concealed and the noise is white."""
    sizes = REFERENCE.copy()
    if setting.plain:
        x, v = np.sqrt(np.mean(setting.pilot[:, :2] ** 2, axis=0))
        sizes = np.array([x * between(rng, 1e-4, 3e-3), v * between(rng, 3e-4, 1e-2), 1e-9, 1e-9])
    told = copy.deepcopy(setting.test.spec)
    return Draft(rng, setting, told, copied(setting.test), sizes, boost)


def any_world(rng: np.random.Generator, boost: float, loaded: bool | None = None) -> Draft:
    """Return a draft of a hybrid test or, a little more often, of a plant alone."""
    if rng.random() < 0.45:
        return open_draft(rng, draw_loop(rng, bool(loaded)), boost)
    return open_draft(rng, draw_plain(rng, loaded), boost)
