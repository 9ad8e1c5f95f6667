"""More cases that no kind of the library is: hidden loads and masses, and what is not in the plant."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from benchmarks.concealed.open.draft import Draft, any_world, open_draft
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.open.worlds import draw_loop

Recipe = Callable[[np.random.Generator, float], Draft]


def hidden_load(name: str) -> Recipe:
    """Return the recipe of a load that nobody recorded: broadband, wandering, or some knocks."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        draft = any_world(rng, boost)
        s, until = draft.scene, draft.setting.duration + 1.0
        band = {"random_load": (0.2 * s.w, 3.0 * s.w), "wandering_load": (0.01 * s.w, 0.15 * s.w)}
        low, high = band.get(name, (0.0, 0.0))
        sines = _knocks(s.rng, until) if name == "knocks" else _broad(s.rng, low, high)
        size = draft.size(0.05, 0.4) * s.F * (8.0 if name == "knocks" else 1.0)
        sines[:, 0] *= size
        draft.conceal({"block": "plant", "kind": name, "sines": sines.tolist(), "until": until})
        draft.hidden.append(Hidden(name, ("plant",), depends=("t",)))
        if name == "knocks":  # their lines have no mean: between two of them the force is constant
            draft.tolerated.append(Hidden("constant force", ("plant",), kind="constant_load"))
        draft.measure = "force"
        return draft

    return recipe


def _broad(rng: np.random.Generator, low: float, high: float) -> np.ndarray:
    """So many lines that nothing repeats itself within the recording."""
    count = 80
    lines = rng.uniform(low, high, count)
    return np.stack([np.full(count, np.sqrt(2.0 / count)), lines, rng.uniform(0.0, 6.28, count)], 1)


def _knocks(rng: np.random.Generator, until: float) -> np.ndarray:
    """A series of cosines that adds up to pulses at a few instants: rows as of sines."""
    count, top = 400, 25.0
    instants = rng.uniform(0.1, 0.9, int(rng.integers(2, 7))) * until
    lines = np.linspace(top / count, top, count)
    waves = np.exp(-1j * np.outer(lines, instants)).sum(axis=1) / count
    return np.stack([np.abs(waves), lines, np.angle(waves) + np.pi / 2.0], 1)


def other_mass(name: str) -> Recipe:
    """Return the recipe of a mass that changes at an instant, or all the time."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        draft = any_world(rng, boost)
        until = draft.setting.duration
        more = draft.size(0.02, 0.3) * draft.spec["plant"]["mass"][0]
        value = until if name == "drifting_mass" else rng.uniform(0.25, 0.75) * until
        draft.conceal({"block": "plant", "kind": name, "values": [more, value]})
        acts = (value, until) if name == "stepping_mass" else None
        hidden = Hidden(name, ("plant",), ("varying",), depends=("t", "a", "x"), interval=acts, several=True)
        draft.hidden.append(hidden)
        draft.measure = "force"
        return draft

    return recipe


def absorber(rng: np.random.Generator, boost: float) -> Draft:
    """A hidden mass on a hardening spring."""
    draft = any_world(rng, boost)
    s = draft.scene
    values = [
        draft.spec["plant"]["mass"][0], draft.size(0.02, 0.1), s.x * s.between(0.5, 2.0),
        s.w * s.between(0.6, 1.6), s.between(0.01, 0.1),
    ]  # fmt: skip
    draft.conceal({"block": "plant", "kind": "nonlinear_absorber", "values": values})
    variables = ("x", "v", "a")
    draft.hidden.append(
        Hidden("nonlinear absorber", ("plant",), ("memory",), depends=variables, several=True)
    )
    draft.measure = "force"
    return draft


def _rope(draft: Draft) -> tuple[dict[str, object], Hidden]:
    if draft.rng.random() < 0.5:
        effect = {"kind": "limp_wire", "limp": draft.size(0.05, 0.4)}
    else:
        effect = {"kind": "bending_wire", "bend": draft.scene.d / draft.size(0.1, 0.6)}
    families = ("stiffness", "contact")
    return {"block": "wire"} | effect, Hidden(effect["kind"], ("wire",), families, depends=("x", "u"))


def _screw(draft: Draft) -> tuple[dict[str, object], Hidden]:
    u = float(np.sqrt(np.mean(draft.setting.pilot[:, 2] ** 2)))
    screw, pitch = draft.size(0.01, 0.05) * u, u * draft.scene.between(0.3, 1.5)
    effect = {"block": "motor", "kind": "screw_error", "screw": screw, "pitch": pitch}
    return effect, Hidden("screw error", ("motor",), depends=("u", "command"), several=True)


def _creep(draft: Draft) -> tuple[dict[str, object], Hidden]:
    u = float(np.sqrt(np.mean(draft.setting.pilot[:, 2] ** 2)))
    rate = draft.scene.sign() * draft.size(0.05, 0.5) * u / draft.setting.duration
    effect = {"block": "motor", "kind": "creeping_motor", "creep": rate}
    return effect, Hidden("creeping motor", ("motor",), ("sensor", "load"), depends=("t",))


def _outage(draft: Draft) -> tuple[dict[str, object], Hidden]:
    block = f"link.tau{draft.rng.integers(1, 5)}"
    width = draft.rng.uniform(0.005, 0.03)
    effect = {"block": block, "kind": "outage", "centre": draft.rng.uniform(0.2, 0.8), "width": width}
    return effect, Hidden("outage", (block,), ("link",), ("dropout",))


def _slower_link(draft: Draft) -> tuple[dict[str, object], Hidden]:
    block = f"link.tau{draft.rng.integers(1, 5)}"
    effect = {"block": block, "kind": "drifting_delay", "drift": draft.size(0.004, 0.015)}
    blocks = (block, "motor") if block == "link.tau4" else (block,)
    return effect, Hidden("drifting delay", blocks, ("link",), ("clock_drift",), depends=("t",))


def in_the_loop(make: Callable[[Draft], tuple[dict[str, object], Hidden]]) -> Recipe:
    """Return the recipe of something that only a hybrid test has."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        draft = open_draft(rng, draw_loop(rng), boost)
        effect, hidden = make(draft)
        draft.conceal(effect)
        draft.hidden.append(hidden)
        draft.measure = "certain" if hidden.blocks[0].startswith("link") else "effects"
        return draft

    return recipe


RECIPES: dict[str, Recipe] = {
    **{name: hidden_load(name) for name in ("random_load", "wandering_load", "knocks")},
    **{name: other_mass(name) for name in ("stepping_mass", "drifting_mass")},
    "nonlinear_absorber": absorber,
    "wire_law": in_the_loop(_rope),
    "screw_error": in_the_loop(_screw),
    "creeping_motor": in_the_loop(_creep),
    "outage": in_the_loop(_outage),
    "drifting_delay": in_the_loop(_slower_link),
}
