"""From the text of a ROS 2 parameter file to values by dotted name, typed as ROS types them.

YAML 1.1, as Python reads it, takes ``1e-3`` for text and ``1:30`` for 90; ROS does neither. So the types here
follow rcl_yaml_param_parser, which is also why aliases are refused and ``y`` is a truth value.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import yaml

from rthm_core.errors import InputError, printable, refusal, shown
from rthm_core.spec.catalogue import ROOT

PARAMETERS = "ros__parameters"
NODES = ("plant", "numerical", "actuator", "analysis")
"""Names of the nodes that take a spec."""

NODE_PARAMETERS = frozenset(
    {
        "use_sim_time",
        "start_type_description_service",
        "start_time",
        "duration",
        "virtual",
        "autostart",
        "priority",
        "lock_memory",
        "spin_margin",
        "depth",
        "reliable",
        "bag",
    }
)
"""Parameters of nodes that may stand beside a spec in its file; they are no part of it."""

_TAG = "tag:yaml.org,2002:"


class _Loader(yaml.SafeLoader):
    """Composer of YAML nodes with ROS's types, without aliases."""

    yaml_implicit_resolvers: dict[str, Any] = {}

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Refuse aliases: ROS does, and they can make a short text grow without end."""
        if self.check_event(yaml.AliasEvent):
            line = self.peek_event().start_mark.line + 1  # type: ignore[no-untyped-call]
            raise InputError(
                f"line {line} has an alias (*name), which ROS cannot read; write the values out."
            )
        return super().compose_node(parent, index)


for _name, _pattern in (
    ("bool", r"[yYnN]|yes|Yes|YES|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF"),
    ("int", r"[-+]?(0|[1-9][0-9]*)"),
    ("float", r"[-+]?([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))([eE][-+]?[0-9]+)?"),
    ("null", r"~|null|Null|NULL|"),
):
    _Loader.add_implicit_resolver(_TAG + _name, re.compile(rf"(?:{_pattern})\Z"), None)


def parameters_in(text: str) -> dict[str, Any]:
    """Values by dotted name, of all nodes' sections that hold parts of a spec.

    Raises
    ------
    InputError
        If the text is no ROS parameter file, a key is there twice, or sections of nodes differ.
    """
    root = _compose(text)
    merged: dict[str, Any] = {}
    for node, section in _node_sections(root, ""):
        for name, value in _flat(section, ""):
            if name in merged and merged[name] != value:
                raise InputError(
                    f"{printable(name)} is {shown(merged[name])}, and {shown(value)} for {printable(node)}, "
                    "but must be the same for all parts of a test; keep one of the two."
                )
            merged[name] = value
    kept = {
        name: value for name, value in merged.items() if name not in NODE_PARAMETERS and not _is_qos(name)
    }
    if not kept:
        raise InputError("the spec has no entries under ros__parameters; at least a section plant is needed.")
    return kept


def _is_qos(name: str) -> bool:
    return name.startswith("qos_overrides.")


def _compose(text: str) -> yaml.MappingNode:
    try:
        root = yaml.compose(text, Loader=_Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" at line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
        raise InputError(
            f"the text is not YAML{where} ({problem}); correct it, or give the path of a spec."
        ) from None
    except RecursionError:
        raise InputError(
            "the text is nested too deeply for a spec; give the text of a ROS parameter file."
        ) from None
    if root is None:
        raise InputError("the spec is empty; give a ROS parameter file, or a shipped spec's name.")
    if not isinstance(root, yaml.MappingNode):
        raise InputError(
            "the text is YAML but no ROS parameter file, which begins /**: ros__parameters:; wrap it so."
        )
    return root


def _node_sections(node: yaml.MappingNode, name: str) -> Iterator[tuple[str, yaml.MappingNode]]:
    """Sections of parameters that belong to a spec, with the names of their nodes."""
    found = list(_all_node_sections(node, name))
    if not found:
        raise InputError(
            "the text has no ros__parameters, but a spec is a ROS parameter file; "
            "put the sections under /**: ros__parameters:."
        )
    return ((name, section) for name, section in found if len(found) == 1 or _is_ours(name, section))


def _all_node_sections(node: yaml.MappingNode, name: str) -> Iterator[tuple[str, yaml.MappingNode]]:
    for key, value in _pairs(node, name):
        if not isinstance(value, yaml.MappingNode):
            way_out = "put the sections under /**: ros__parameters:"
            raise refusal(key, _value(value), "a section with ros__parameters", way_out)
        if key == PARAMETERS and name:
            yield name, value
        else:
            yield from _all_node_sections(value, f"{name}/{key}" if name else key)


def _is_ours(name: str, section: yaml.MappingNode) -> bool:
    """Whether a section is for every node, for one of ours, or holds a part of a spec anyway."""
    last = name.rpartition("/")[2]
    return (
        "*" in last or last in NODES or any(key.partition(".")[0] in ROOT for key, _ in _pairs(section, name))
    )


def _pairs(node: yaml.MappingNode, name: str) -> Iterator[tuple[str, yaml.Node]]:
    """Keys, always text as in ROS, and values; a key that is there twice is refused."""
    seen: set[str] = set()
    for key_node, value in node.value:
        if not isinstance(key_node, yaml.ScalarNode):
            line = key_node.start_mark.line + 1
            raise InputError(f"line {line} has a key that is not text; write a name before the colon.")
        key = key_node.value
        if key in seen:
            line, dotted = key_node.start_mark.line + 1, printable(f"{name}.{key}" if name else key)
            raise InputError(
                f"{dotted} is there twice, again at line {line}, but must be there once; remove one."
            )
        seen.add(key)
        yield key, value


def _flat(node: yaml.MappingNode, name: str) -> Iterator[tuple[str, Any]]:
    for key, value in _pairs(node, name):
        dotted = f"{name}.{key}" if name else key
        if isinstance(value, yaml.MappingNode):
            yield from _flat(value, dotted)
        else:
            yield dotted, _value(value)


def _value(node: yaml.Node) -> Any:
    if isinstance(node, yaml.SequenceNode):
        return [_value(one) for one in node.value]
    if isinstance(node, yaml.MappingNode):
        return {key: _value(value) for key, value in _pairs(node, "")}
    return _scalar(node.tag.removeprefix(_TAG), node.value)


def _scalar(tag: str, text: str) -> Any:
    if tag == "bool":
        return text.lower() in ("y", "yes", "true", "on")
    if tag == "null":
        return None
    try:
        return int(text) if tag == "int" else float(text) if tag == "float" else text
    except ValueError:
        return text
