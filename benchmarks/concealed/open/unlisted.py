"""Cases that no kind of the library is: parameters of laws, drawn, and what states them rightly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from benchmarks.concealed.amounts import Scene
from benchmarks.concealed.open.draft import Draft, any_world
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.strange import LAWS, force, friction

Values = Callable[[Scene, float], list[float]]
SPRINGS, DAMPERS = ("stiffness",), ("drag", "damping")
POWERS = (0.5, 1.5, 1.7, 2.5)
RUBS, CONTACT, VARYING = ("friction",), ("contact",), ("varying",)


def _top(s: Scene) -> float:
    return float(np.abs(s.pilot[:, 0]).max())


def _instant(s: Scene, until: float) -> float:
    return float(s.rng.uniform(0.25, 0.75)) * until


def _interval(s: Scene, until: float) -> list[float]:
    begin = s.rng.uniform(0.1, 0.55)
    return [begin * until, (begin + s.rng.uniform(0.15, 0.4)) * until]


def _band(s: Scene) -> list[float]:
    """A third of the way, or so, that is passed often."""
    low, high = np.sort(s.rng.choice(np.quantile(s.pilot[:, 0], np.linspace(0.1, 0.9, 9)), 2, replace=False))
    return [float(low), float(max(high, low + 0.3 * s.x))]


def _hills(s: Scene) -> list[float]:
    """Six hills of the force over position and velocity."""
    rows = [[s.rng.normal(), s.rng.uniform(-1.2, 1.2), s.rng.uniform(-1.2, 1.2)] for _ in range(6)]
    return [_top(s), float(np.abs(s.pilot[:, 1]).max()), *np.ravel(rows).tolist()]


# Name -> parameters behind the force, families that state it, variables on which it depends.
PLANT: dict[str, tuple[Values, tuple[str, ...], str]] = {
    "magnet": (lambda s, T: [s.sign() * _top(s) * s.between(1.3, 2.5)], SPRINGS, "x"),
    "cogging": (lambda s, T: [s.x * s.between(0.3, 2.0), s.rng.uniform(0, 6.28)], SPRINGS, "x"),
    "tanh_spring": (lambda s, T: [s.x * s.between(0.15, 0.6)], SPRINGS, "x"),
    "sine_stiffness": (lambda s, T: [_top(s) / s.between(1.2, 3.0)], SPRINGS, "x"),
    "exponential_spring": (lambda s, T: [s.sign() * _top(s) / s.between(1.0, 3.0)], SPRINGS, "x"),
    "quintic_spring": (lambda s, T: [s.x], SPRINGS, "x"),
    "detent": (lambda s, T: [s.x * s.rng.uniform(-1, 1), s.x * s.between(0.1, 0.5)], SPRINGS, "x"),
    "position_damping": (lambda s, T: [s.x, s.v], DAMPERS, "xv"),
    "fractional_drag": (lambda s, T: [s.v, float(s.rng.choice(POWERS))], (*DAMPERS, *RUBS), "v"),
    "feeding": (lambda s, T: [s.x * s.between(0.5, 1.5), s.v], DAMPERS, "xv"),
    "cubic_damping": (lambda s, T: [s.v], DAMPERS, "v"),
    "speed_governor": (lambda s, T: [s.v * s.between(0.5, 1.5)], DAMPERS, "v"),
    "local_damper": (lambda s, T: [s.v, s.x * s.rng.uniform(-0.7, 0.7)], DAMPERS, "xv"),
    "cross_force": (lambda s, T: [s.x, s.v], DAMPERS, "xv"),
    "surface": (lambda s, T: _hills(s), (*SPRINGS, *DAMPERS), "xv"),
    "parametric_stiffness": (
        lambda s, T: [s.x, s.w * s.between(0.2, 3.0), s.rng.uniform(0, 6.28)], VARYING, "xt"),
    "stepping_stiffness": (lambda s, T: [s.x, _instant(s, T)], VARYING, "xt"),
    "drifting_stiffness": (lambda s, T: [s.x, T], VARYING, "xt"),
    "stepping_damping": (lambda s, T: [s.v, _instant(s, T)], VARYING, "vt"),
    "drifting_damping": (lambda s, T: [s.v, T], VARYING, "vt"),
    "catching_cable": (
        lambda s, T: [s.x, s.x * s.rng.uniform(-0.3, 0.5), *_interval(s, T)], CONTACT + VARYING, "xt"),
    "late_cable": (
        lambda s, T: [s.x, s.x * s.rng.uniform(-0.3, 0.5), s.rng.uniform(0.75, 0.9) * T, 2 * T],
        CONTACT + VARYING, "xt"),
    "rubbing_seal": (lambda s, T: [s.v, *_interval(s, T)], (*VARYING, *DAMPERS), "vt"),
    "interval_friction": (lambda s, T: _band(s), RUBS, "xv"),
    "asymmetric_friction": (
        lambda s, T: [s.sign() * s.rng.uniform(0.3, 0.9)], (*RUBS, "constant_load"), "v"),
    "growing_friction": (lambda s, T: [T], RUBS, "vt"),
    "wedge_friction": (lambda s, T: [s.x], RUBS, "xv"),
    "stepping_friction": (lambda s, T: [_instant(s, T)], RUBS, "vt"),
    "sloping_friction": (lambda s, T: [s.sign() * s.x * s.between(0.7, 2.0)], RUBS, "xv"),
    "lugre": (
        lambda s, T: [s.x * s.between(0.02, 0.2), s.v * s.between(0.05, 0.3), s.rng.uniform(0.2, 0.8)],
        (*RUBS, "hysteresis"), "xv"),
    "square_input": (lambda s, T: [_load(s)], (), "load"),
    "rectified_input": (lambda s, T: [_load(s)], (), "load"),
    "modulated_input": (lambda s, T: [_load(s), s.x], (), "xload"),
}  # fmt: skip
ACTS: dict[str, Callable[[list[float], float], tuple[float, float]]] = {
    "catching_cable": lambda q, T: (q[2], q[3]),
    "late_cable": lambda q, T: (q[2], T),
    "rubbing_seal": lambda q, T: (q[1], q[2]),
    "stepping_stiffness": lambda q, T: (q[1], T),
    "stepping_damping": lambda q, T: (q[1], T),
    "stepping_friction": lambda q, T: (q[0], T),
}
"""When laws act that do not all the time, from their parameters and the length of the test."""
MEMORY = ("lugre",)
NAMES = {"late_cable": "catching_cable"}  # of the law, where the case has another name
DRIVEN = ("square_input", "rectified_input", "modulated_input")
_VARIABLES = {"xload": ("x", "load"), "load": ("load",)}


def _load(s: Scene) -> float:
    """Size of the known load."""
    return float(np.sqrt(np.mean(s.known**2)))


def amplitude(name: str, values: list[float], size: float, s: Scene, until: float) -> float:
    """Force A with which a law has `size` times the rms of the wire's, or the spring's, force."""
    q = np.array([LAWS[name][0], 1.0, *values])
    t = np.linspace(0.0, until, len(s.pilot))
    rows = zip(t, s.pilot[:, 0], s.pilot[:, 1], s.known, strict=True)
    if q[0] >= 100.0:
        acts = [friction(a, x, np.sign(v), q) for a, x, v, _ in rows]
    elif q[0] >= 70.0:
        acts = [1.0]
    else:
        acts = [force(a, x, v, w, 0.0, 0.0, q) for a, x, v, w in rows]
    return size * s.F / float(np.sqrt(np.mean(np.square(acts))) or 1.0)


def plant_law(name: str) -> Callable[[np.random.Generator, float], Draft]:
    """Return the recipe of a law on the plant."""
    values, families, depends = PLANT[name]
    law = NAMES.get(name, name)

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        draft = any_world(rng, boost, loaded=True if name in DRIVEN else None)
        scene = draft.known_scene
        q = values(scene, draft.setting.duration)
        A = amplitude(law, q, draft.size(), scene, draft.setting.duration)
        draft.conceal({"block": "plant", "kind": law, "values": [A, *q]})
        variables = _VARIABLES.get(depends, tuple(depends))
        until = draft.setting.duration
        acts = ACTS[name](q, until) if name in ACTS else None
        hidden = Hidden(name, ("plant",), families, depends=variables, interval=acts, several=name in MEMORY)
        draft.hidden.append(hidden)
        draft.measure = "force"
        return draft

    return recipe
