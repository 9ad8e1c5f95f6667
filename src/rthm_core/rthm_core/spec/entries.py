"""Kinds of entry of a spec: ROS type, unit, bounds, description, and the way from what was given to a value.

Used as ``Annotated[tuple[float, ...], Numbers("kg", "mass matrix")]``: pydantic calls `convert`; ROS
descriptors and the reference page read the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from rthm_core.errors import RefusedError, printable, suggestion
from rthm_core.quantity import Quantity, Text, as_number

LARGEST_WHOLE = 2**53
"""Largest integer that a float holds exactly."""


class Entry:
    """One entry of a section; subclasses are frozen dataclasses."""

    type: ClassVar[str]
    """ROS parameter type: double, double_array, integer, string or string_array."""

    description: Any
    unit: Any

    @property
    def allowed(self) -> str:
        """What may be given, as the end of "must be ..."."""
        raise NotImplementedError

    def convert(self, value: Any) -> Any:
        """Return the value to store; raise RefusedError if it is not allowed."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.convert, handler(source))


@dataclass(frozen=True)
class Number(Quantity, Entry):
    """A finite number."""

    type = "double"


@dataclass(frozen=True)
class Numbers(Quantity, Entry):
    """A list of finite numbers, all within the same bounds."""

    count: int | None = None
    type = "double_array"

    @property
    def allowed(self) -> str:
        """What may be given."""
        many = "" if self.count is None else f"{self.count} "
        return f"a list of {many}finite numbers" + (f", each {self.bounds}" if self.bounds else "")

    def convert(self, value: Any) -> tuple[float, ...]:  # type: ignore[override]
        """Return the numbers; integers and text such as ``1e-3`` are numbers."""
        values = as_list(value, self.allowed, lone=as_number(value) is not None)
        if self.count is not None and len(values) != self.count:
            raise RefusedError(value, self.allowed, f"give {self.count} numbers, not {len(values)}")
        return tuple(self._element(i, one) for i, one in enumerate(values))

    def _element(self, index: int, value: Any) -> float:
        try:
            return super().convert(value)
        except RefusedError as refused:
            allowed = super().allowed + refused.allowed.removeprefix(self.allowed)
            raise RefusedError(value, allowed, within=f"[{index}]") from None


@dataclass(frozen=True)
class Whole(Entry):
    """A whole number."""

    unit: str
    description: str
    minimum: int = 0
    maximum: int = LARGEST_WHOLE
    type = "integer"

    @property
    def allowed(self) -> str:
        """What may be given."""
        return f"a whole number from {self.minimum} to {self.maximum}"

    def convert(self, value: Any) -> int:
        """Return the number; 3, 3.0 and "3" are whole."""
        number = as_number(value)
        if number is None or not self.minimum <= number <= self.maximum or number != int(number):
            raise RefusedError(value, self.allowed)
        return int(value) if isinstance(value, int) else int(number)


@dataclass(frozen=True)
class Name(Text, Entry):
    """A name."""

    type = "string"
    unit = ""


@dataclass(frozen=True)
class Names(Text, Entry):
    """A list of names."""

    type = "string_array"
    unit = ""
    allowed = "a list of names"

    def convert(self, value: Any) -> tuple[str, ...]:  # type: ignore[override]
        """Return the names."""
        values = as_list(value, self.allowed, lone=isinstance(value, str))
        return tuple(self._element(i, one) for i, one in enumerate(values))

    def _element(self, index: int, value: Any) -> str:
        try:
            return super().convert(value)
        except RefusedError as refused:
            raise RefusedError(value, Text.allowed, refused.way_out, within=f"[{index}]") from None


@dataclass(frozen=True)
class Choice(Entry):
    """One of a few words."""

    choices: tuple[str, ...]
    description: str
    type = "string"
    unit = ""

    @property
    def allowed(self) -> str:
        """What may be given."""
        return f"one of {', '.join(self.choices)}"

    def convert(self, value: Any) -> str:
        """Return the word."""
        if not isinstance(value, str) or value not in self.choices:
            raise RefusedError(value, self.allowed, suggestion(str(value), self.choices))
        return value


def as_list(value: Any, allowed: str, *, lone: bool) -> list[Any]:
    """Return the elements; a `lone` value that could be one is refused with advice, as ROS needs a list."""
    if getattr(value, "ndim", 0) == 1 or (isinstance(value, Sequence) and not isinstance(value, str | bytes)):
        return list(value)
    if lone:
        raise RefusedError(value, allowed, f"write it in brackets, [{printable(str(value))}]")
    raise RefusedError(value, allowed)
