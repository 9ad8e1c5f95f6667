"""The schema as data: every section with its class, every entry with its dotted name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args

from rthm_core.spec.effect import EffectSpec
from rthm_core.spec.entries import Entry
from rthm_core.spec.schema import Spec
from rthm_core.spec.sections import Section

ROOT = tuple(Spec.model_fields)
"""Keys at the root of a spec, beside the sections of effects."""


def section_classes(annotation: Any) -> list[type[Section]]:
    """Classes of section in a field's annotation; several for a load, none for an entry."""
    if isinstance(annotation, type) and issubclass(annotation, Section) and annotation is not EffectSpec:
        return [annotation]
    return [found for inner in get_args(annotation) for found in section_classes(inner)]


def sections(of: type[Section] = Spec, key: str = "") -> Iterator[tuple[str, type[Section]]]:
    """Dotted name and class of every section; the spec itself has the name ``""``."""
    yield key, of
    for name, field in of.model_fields.items():
        for inner in section_classes(field.annotation):
            yield from sections(inner, f"{key}.{name}" if key else name)


def keys_in(section: str) -> list[str]:
    """Names of the keys that can stand in a section; empty if there is no such section."""
    return list(dict.fromkeys(name for key, of in sections() if key == section for name in of.model_fields))


def entry_at(key: str) -> Entry | None:
    """Entry of a dotted name such as ``plant.mass``."""
    section, _, name = key.rpartition(".")
    for known, of in sections():
        if known == section:
            for field, entry in of.entries():
                if field == name:
                    return entry
    return None
