"""A first spec, as a file with comments: to be corrected until it is that of a rig."""

from __future__ import annotations

from collections.abc import Mapping

from rthm_core.spec.changes import apply
from rthm_core.spec.commenting import commented_spec
from rthm_core.spec.reading import shipped_spec
from rthm_core.spec.schema import Spec, UncertaintySpec

LIKE = "paper"
"""Shipped spec from which a first one starts when none is named: the least that a hybrid test needs."""

SPREAD = {"mass": 0.05, "damping": 0.5, "stiffness": 0.05}
"""How well the properties of a rig are known before anything was measured, by experience: standard deviation
over value."""

UNCERTAINTY = (
    "One standard deviation over the value. Within these a diagnosis first looks for other values (verdict "
    "retuned) before it names physics that is missing. Without this section, or with 0, a value counts as "
    "exact: a rig that has another one contradicts its spec, and the diagnosis reports it."
)
"""What an uncertainty is for."""

UNWEIGHED = (
    "No known force acts, and a free decay shows only damping and stiffness over mass: so the mass counts as "
    "exact here, 0. Weigh it."
)
"""Why the mass of a free plant has no uncertainty."""

MORE = (
    "Not in here: limits, which a machine needs (command, rate, force, stale and ramp), zero (rthm "
    "zero writes it), effects (rthm effects lists them). docs/reference/spec.md has every entry, its bounds "
    "and its default."
)
"""Sections that a first spec leaves out."""


def first_spec(name: str = LIKE) -> str:
    """Return a shipped spec as text with comments, and with an uncertainty of its physical properties.

    Raises
    ------
    InputError
        If there is no shipped spec of that name.
    """
    spec = shipped_spec(name)
    head = f"First spec, begun as the shipped spec {name}: put in what your rig has."
    notes = {}
    if spec.uncertainty == UncertaintySpec():
        spec = apply(spec, _uncertainty(spec))
        notes = {"uncertainty": UNCERTAINTY if _driven(spec) else f"{UNCERTAINTY} {UNWEIGHED}"}
    return first_text(spec, head, notes)


def first_text(spec: Spec, head: str, notes: Mapping[str, str]) -> str:
    """Return a spec as text with comments, the last of which says what a spec can have beside."""
    return commented_spec(spec, f"{head}\n{MORE}", notes)


def _uncertainty(spec: Spec) -> dict[str, float]:
    spread = {f"uncertainty.plant.{name}": size for name, size in SPREAD.items()}
    if not _driven(spec):
        spread["uncertainty.plant.mass"] = 0.0
    return spread | ({"uncertainty.actuator.stiffness": SPREAD["stiffness"]} if spec.is_loop else {})


def _driven(spec: Spec) -> bool:
    """Whether a known force acts on the plant, without which nobody can tell its mass."""
    load = spec.load.plant
    return spec.is_loop or (load is not None and load.kind != "none")
