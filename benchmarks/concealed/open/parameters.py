"""Cases with plain errors: other masses, dampings, stiffnesses, gains, offsets than the spec says."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from benchmarks.concealed.open.draft import Draft, any_world, open_draft
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.open.worlds import between, draw_loop, draw_plain

Recipe = Callable[[np.random.Generator, float], Draft]
FACTORS = {"mass": (0.01, 0.3), "damping": (0.5, 3.0), "stiffness": (0.01, 0.3)}
TOLD = 0.25  # share of the cases whose spec states an uncertainty


def plant_values(draft: Draft) -> dict[str, float]:
    """True parameters of the plant, in the rig's units; none of a free decay: it fixes ratios only."""
    plant = draft.setting.scale.spec({"plant": draft.spec["plant"]})["plant"]
    known = not draft.setting.plain or draft.setting.loaded
    return {f"plant.{k}": plant[k][0] for k in ("mass", "damping", "stiffness")} if known else {}


def plant_error(*names: str) -> Recipe:
    """Return the recipe of a plant of which these parameters are told wrongly."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        draft = any_world(rng, boost)
        for name in names:
            off = min(between(rng, *FACTORS[name]) * boost, 3.0 if name == "damping" else 0.5)
            factor = 1.0 + off if rng.random() < 0.5 else 1.0 / (1.0 + off)
            draft.told["plant"][name] = [draft.spec["plant"][name][0] * factor]
        _retuned(draft, " and ".join(names), boost)
        return draft

    return recipe


def _retuned(draft: Draft, what: str, boost: float) -> None:
    """Note an error of the plant's parameters; any of the three may take it up, or part of it."""
    names = ("plant.mass", "plant.damping", "plant.stiffness")
    draft.hidden.append(Hidden(what, ("plant",), retuned=names, parameters=plant_values(draft)))
    draft.measure = "plant"
    if draft.rng.random() < TOLD:
        told, true = draft.told["plant"], draft.spec["plant"]
        off = {k: abs(true[k][0] / told[k][0] - 1.0) for k in FACTORS}
        floor = {"mass": 0.02, "damping": 0.3, "stiffness": 0.02}
        sure = {k: float(f"{max(off[k], floor[k]):.2g}") for k in FACTORS}
        draft.told["uncertainty"] = {"plant": sure}


def issue_rig(rng: np.random.Generator, boost: float) -> Draft:
    """A linear rig: k a few per cent off, c three times the spec's, a plain recording, no uncertainty."""
    draft = open_draft(rng, draw_plain(rng, rig="bench"), boost)
    draft.told["plant"]["stiffness"] = [draft.spec["plant"]["stiffness"][0] / 1.027]
    draft.told["plant"]["damping"] = [draft.spec["plant"]["damping"][0] / 3.0]
    names = ("plant.mass", "plant.damping", "plant.stiffness")
    draft.hidden.append(Hidden("k and c", ("plant",), retuned=names, parameters=plant_values(draft)))
    draft.measure = "plant"
    return draft


def wire_error(rng: np.random.Generator, boost: float) -> Draft:
    """The wire is stiffer, or softer, than all that compute with it believe."""
    draft = open_draft(rng, draw_loop(rng), boost)
    factor = 1.0 + float(rng.choice([-1.0, 1.0])) * min(between(rng, 0.01, 0.3) * boost, 0.4)
    k_tot = draft.spec["actuator"]["stiffness"][0]
    true = k_tot * factor
    draft.conceal(
        {"block": "controller", "kind": "wrong_parameter", "name": "actuator.stiffness", "value": k_tot}
    )
    draft.spec["actuator"]["stiffness"] = [true]
    value = draft.setting.scale.spec({"actuator": {"stiffness": [true]}})["actuator"]["stiffness"][0]
    draft.hidden.append(
        Hidden(
            "k_tot",
            ("wire",),
            retuned=("actuator.stiffness",),
            parameters={"actuator.stiffness": value},
        )
    )
    draft.measure = "plant"
    return draft


def load_gain(rng: np.random.Generator, boost: float) -> Draft:
    """The known load of a plant alone is not as large as recorded: another m, c and k, seen from it."""
    draft = open_draft(rng, draw_plain(rng, loaded=True), boost)
    factor = 1.0 + float(rng.choice([-1.0, 1.0])) * min(between(rng, 0.03, 0.3) * boost, 0.5)
    for name in FACTORS:
        draft.told["plant"][name] = [v * factor for v in draft.spec["plant"][name]]
    names = ("plant.mass", "plant.damping", "plant.stiffness")
    blocks = ("plant", "sensor.load", "sensor.force", "sensor.position", "load")
    values = plant_values(draft)
    draft.hidden.append(
        Hidden("gain of the load", blocks, faults=("unit",), kind="scale", retuned=names, parameters=values)
    )
    draft.measure = "plant"
    return draft


def offset(rng: np.random.Generator, boost: float) -> Draft:
    """A constant: a force, or the zero of a sensor; in a plant alone these are the same."""
    draft = any_world(rng, boost)
    size = draft.size(0.02, 0.15)
    if draft.setting.plain:
        draft.conceal_kind("plant", "constant_load", size)
        only = draft.hidden[0]
        blocks = ("plant", "sensor.position", "sensor.load", "sensor.force")
        draft.hidden = [Hidden(only.what, blocks, ("load", "sensor"), (), (), (), only.parameters, only.kind)]
    else:
        block = str(rng.choice(["plant", "sensor.velocity", "sensor.force"]))
        draft.conceal_kind(block, "constant_load" if block == "plant" else "bias", size)
    draft.measure = "effects" if not draft.setting.plain else "certain"
    return draft


RECIPES: dict[str, Recipe] = {
    "issue_rig": issue_rig,
    "mass": plant_error("mass"),
    "damping": plant_error("damping"),
    "stiffness": plant_error("stiffness"),
    "mass_and_damping": plant_error("mass", "damping"),
    "all_three": plant_error("mass", "damping", "stiffness"),
    "wire_stiffness": wire_error,
    "load_gain": load_gain,
    "offset": offset,
}
