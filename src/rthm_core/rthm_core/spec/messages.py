"""From what pydantic found to one sentence for the user."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from rthm_core.errors import MISSING, InputError, RefusedError, joined, refusal, unknown
from rthm_core.spec.catalogue import entry_at, keys_in
from rthm_core.spec.load import LOAD_KINDS

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails


def input_error(error: ValidationError, tree: dict[str, Any]) -> InputError:
    """Return the most telling of pydantic's findings as one sentence; `tree` is what was validated.

    An unknown key comes first: it is the reason why the key that it was meant to be is missing.
    """
    findings = error.errors(include_url=False)
    first = min(findings, key=lambda finding: finding["type"] != "extra_forbidden")
    return _sentence(first, _key(first["loc"], tree))


def _key(loc: tuple[int | str, ...], tree: dict[str, Any]) -> str:
    """Dotted name as in the file: without the kind of a load and the index of an effect."""
    parts = list(loc)
    if parts[:1] == ["load"] and len(parts) > 2 and parts[2] in LOAD_KINDS:
        del parts[2]
    if parts[:1] == ["effects"] and len(parts) > 1 and isinstance(parts[1], int):
        parts[:2] = [tree["effects"][parts[1]]["name"]]
        parts = [part for part in parts if part != "parameters"]
    key = ""
    for part in parts:
        key = joined(key, f"[{part}]" if isinstance(part, int) else str(part))
    return key


def _sentence(finding: ErrorDetails, key: str) -> InputError:
    kind, value = finding["type"], finding["input"]
    cause = finding.get("ctx", {}).get("error")
    if isinstance(cause, RefusedError):
        return cause.at(key)
    if kind == "extra_forbidden":
        section = key.rpartition(".")[0]
        return unknown(key, value, _keys_beside(section, finding["loc"]))
    if kind == "missing":
        entry = entry_at(key)
        wanted = f"given: {entry.description}, {entry.allowed}" if entry else "given"
        return refusal(key, MISSING, wanted, f"add {key}")
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        given = value.get("kind", MISSING) if isinstance(value, dict) else value
        return refusal(f"{key}.kind", given, f"one of {', '.join(LOAD_KINDS)}")
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return refusal(key, value, f"a section with {', '.join(keys_in(key))}")
    return InputError(f"{key or 'the spec'} cannot be used: {finding['msg']}; correct it.")


def _keys_beside(section: str, loc: tuple[int | str, ...]) -> list[str]:
    if loc[:1] == ("load",) and len(loc) > 2 and loc[2] in LOAD_KINDS:
        return list(LOAD_KINDS[str(loc[2])].model_fields)
    return keys_in(section)
