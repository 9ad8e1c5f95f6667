"""Write a spec as a ROS 2 parameter file that ROS and every YAML reader understand alike.

Numbers are always floats with a dot, names are quoted, and empty lists are left out, as ROS cannot type them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, NamedTuple

from rthm_core.spec.building import nested
from rthm_core.spec.catalogue import sections
from rthm_core.spec.parameters import values
from rthm_core.spec.schema import Spec

KEYS = {name for _, section in sections() for name in section.model_fields}


HEAD = ("/**:", "  ros__parameters:")
"""Lines with which every file begins."""


class Line(NamedTuple):
    """Line of a file: the dotted name that it is about, and its text; a section begins or has a value."""

    name: str
    text: str
    is_section: bool


def write_spec(spec: Spec) -> str:
    """Return the spec as YAML text with every default written out; `read_spec` of it gives the same spec."""
    return "\n".join([*HEAD, *(line.text for line in lines(spec))]) + "\n"


def lines(spec: Spec) -> Iterator[Line]:
    """Lines of the file below its head."""
    return _lines(nested(values(spec)), "    ", "")


def _lines(tree: dict[str, Any], indent: str, within: str) -> Iterator[Line]:
    for key, value in tree.items():
        dotted = f"{within}.{key}" if within else key
        if isinstance(value, dict):
            name = (
                key if key in KEYS else json.dumps(key)
            )  # an effect may be called "on", which is true in YAML
            yield Line(dotted, f"{indent}{name}:", is_section=True)
            yield from _lines(value, indent + "  ", dotted)
        else:
            yield Line(dotted, f"{indent}{key}: {_text(value)}", is_section=False)


def _text(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_text(one) for one in value)}]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    return _float(value + 0.0) if isinstance(value, float) else str(value)  # no zero below zero


def _float(value: float) -> str:
    """Shortest text that gives the same float; the dot keeps ``1e-05`` from being a string to YAML 1.1."""
    mantissa, e, exponent = repr(value).partition("e")
    return f"{mantissa}{'' if '.' in mantissa else '.0'}{e}{exponent}"
