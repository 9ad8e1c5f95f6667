"""Effects in a spec: user-named sections that the registry of effects checks."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import Field, ValidationInfo, field_validator

from rthm_core.effects import Effect, effect
from rthm_core.effects.blocks import PLACES, check_block
from rthm_core.effects.declaration import Change
from rthm_core.errors import MISSING, RefusedError, printable, shown, suggestion
from rthm_core.quantity import Quantity
from rthm_core.spec.entries import Name
from rthm_core.spec.sections import Section
from rthm_core.topics import LINKS

HEAD = ("block", "kind", "dof", "relative_to", "actuator", "link", "uncertainty")
"""Keys of an effect's section that are not parameters of its kind."""

FITTED = ("plant", "wire")
"""Blocks whose effects may be uncertain."""

SPREAD = Quantity("1", "relative standard deviation of this parameter; 0: exact", minimum=0.0, maximum=100.0)
"""How well a parameter is known."""


class EffectSpec(Section):
    """One effect: its name, where it is, what it is, and its parameters."""

    name: Annotated[str, Name("name of the effect, which is the name of its section")]
    block: Annotated[str, Name("where it is")]
    kind: Annotated[str, Name("what it is")]
    dof: Annotated[str | None, Name("dof at which it acts")] = None
    relative_to: Annotated[
        str | None,
        Name(
            "other dof, where the effect acts between two: it feels the opposite, and the law gets their "
            "motion apart, unless the kind says otherwise"
        ),
    ] = None
    actuator: Annotated[str | None, Name("actuator that has it")] = None
    parameters: Annotated[dict[str, float | str], Field(validate_default=True)] = {}
    uncertainty: dict[str, float] = {}

    @property
    def law(self) -> type[Effect]:
        """What its kind declares."""
        return effect(self.kind, self.block).given(self.parameters)

    @property
    def numbers(self) -> dict[str, float]:
        """Its parameters but for texts."""
        return {name: value for name, value in self.parameters.items() if not isinstance(value, str)}

    @property
    def ordered(self) -> tuple[float, ...]:
        """Its numbers in the order in which the functions of its law get them."""
        numbers = self.numbers
        return tuple(numbers[name] for name in self.law.parameters if name in numbers)

    @property
    def link(self) -> str | None:
        """Link that has it, such as ``tau1``; None in other blocks."""
        return self.block.removeprefix("link.") if self.block.startswith("link.") else None

    @property
    def place(self) -> str:
        """Name of the dof (``x1 relative to x2``), the actuator or the block that it sits at."""
        if self.relative_to is not None:
            return between(str(self.dof), self.relative_to)
        return self.dof or self.actuator or self.block

    @field_validator("block")
    @classmethod
    def _known_block(cls, block: str) -> str:
        return check_block(block)

    @field_validator("kind")
    @classmethod
    def _known_kind(cls, kind: str, info: ValidationInfo) -> str:
        if "block" in info.data:
            try:
                effect(kind, info.data["block"])
            except RefusedError as refused:
                raise RefusedError(kind, refused.allowed, refused.way_out) from None
        return kind

    @field_validator("parameters", mode="before")
    @classmethod
    def _known_parameters(cls, given: dict[str, Any], info: ValidationInfo) -> dict[str, float | str]:
        if "block" not in info.data or "kind" not in info.data:
            return {}
        declared = effect(info.data["kind"], info.data["block"]).given(given).parameters
        for name in given:
            if name not in declared:
                raise _unknown(name, given[name], info.data, tuple(declared))
        values: dict[str, float | str] = {}
        for name, entry in declared.items():
            if name not in given and getattr(entry, "default", None) is None:
                raise RefusedError(MISSING, f"given: {entry.description}", f"add {name}", name)
            try:
                values[name] = entry.convert(given.get(name, getattr(entry, "default", None)))
            except RefusedError as refused:
                raise RefusedError(refused.value, refused.allowed, refused.way_out, name) from None
        return values

    @field_validator("uncertainty", mode="before")
    @classmethod
    def _known_uncertainty(cls, given: Any, info: ValidationInfo) -> dict[str, float]:
        if not {"block", "parameters"} <= info.data.keys():
            return {}
        numbers = [name for name, one in info.data["parameters"].items() if not isinstance(one, str)]
        if not isinstance(given, dict):
            raise RefusedError(given, f"a section with {' or '.join(numbers)}")
        if given and info.data["block"] not in FITTED:
            raise RefusedError(given, f"left out, as it is only of effects of {' or '.join(FITTED)}")
        values = {}
        for name, value in given.items():
            if name not in numbers:
                allowed = f"left out, as only {' and '.join(numbers)} may be uncertain"
                raise RefusedError(value, allowed, suggestion(name, numbers), name)
            try:
                values[name] = SPREAD.convert(value)
            except RefusedError as refused:
                raise RefusedError(refused.value, refused.allowed, refused.way_out, name) from None
        return values


def _unknown(name: str, value: Any, head: dict[str, Any], declared: tuple[str, ...]) -> RefusedError:
    known = (*HEAD, *declared)
    allowed = (
        f"left out, as {head['kind']} of {head['block']} has only {', '.join(declared) or 'no parameters'}"
    )
    return RefusedError(value, allowed, suggestion(name, known) or f"remove {printable(name)}", name)


def from_section(name: str, section: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of an `EffectSpec` from a section as it stands in a file.

    A block of ``link`` with a link of ``tau1`` is the block ``link.tau1``.
    """
    head = {key: section[key] for key in HEAD if key in section}
    block, link = head.get("block"), head.pop("link", None)
    if link is not None:
        if link not in LINKS:
            raise RefusedError(link, f"one of {', '.join(LINKS)}", within="link")
        if block not in ("link", f"link.{link}"):
            raise RefusedError(link, f"the link of its block {shown(block)}", "say it once, in block", "link")
        head["block"] = f"link.{link}"
    rest = {key: value for key, value in section.items() if key not in HEAD}
    return {"name": name, **head, "parameters": rest}


def sizes(
    effects: Iterable[EffectSpec], block: str, changes: Change, place: str | None = None
) -> list[float]:
    """By how much each of some effects changes something of a block, as of `place` in it.

    Examples
    --------
    >>> late = EffectSpec(name="late", block="link.tau1", kind="extra_delay", parameters={"delay": 0.002})
    >>> sizes([late], "link.tau1", "delay"), sizes([late], "link.tau2", "delay")
    ([0.002], [])
    """
    return [
        next(iter(one.numbers.values()))
        for one in effects
        if one.block == block and place in (None, one.place) and one.law.changes == changes
    ]


RELATIVE = " relative to "


def between(dof: str, other: str) -> str:
    """The place between two dofs.

    Examples
    --------
    >>> between("x1", "x2")
    'x1 relative to x2'
    """
    return f"{dof}{RELATIVE}{other}"


def place_keys(place: str) -> tuple[str, str | None]:
    """Dof of a place on the plant, and the one relative to which it moves, if any.

    Examples
    --------
    >>> place_keys("x1 relative to x2"), place_keys("x1")
    (('x1', 'x2'), ('x1', None))
    """
    dof, between, other = place.partition(RELATIVE)
    return dof, other if between else None


def placed(block: str, place: str) -> dict[str, str]:
    """Keys of a spec that name a place in a block; none in a block that is one thing.

    Examples
    --------
    >>> placed("plant", "x1 relative to x2"), placed("wire", "a1")
    ({'dof': 'x1', 'relative_to': 'x2'}, {'actuator': 'a1'})
    """
    key = PLACES.get(block)
    if key is None:
        return {}
    name, other = place_keys(place)
    return {key: name} if other is None else {key: name, "relative_to": other}
