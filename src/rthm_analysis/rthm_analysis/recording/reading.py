"""From a bag to a `Recording`: the tables of the loop's topics, the spec, and what had to be mended."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from rthm_analysis.recording.cdr import decode_diagnostics, decode_string
from rthm_analysis.recording.files import read_raw
from rthm_analysis.recording.host_clocks import HostClocks, host_clocks
from rthm_analysis.recording.raw import RawBag, RawTopic
from rthm_analysis.recording.recording import ABSENT, UNUSABLE, Recording
from rthm_analysis.recording.synchronised import as_ticked
from rthm_analysis.recording.table import LinkTable, Table, joint_table, link_table
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.events import read_event
from rthm_core.spec import Spec, read_spec
from rthm_core.topics import (
    ACCELERATION,
    CLOCKS,
    COMMAND,
    DIAGNOSTICS,
    ENERGY,
    EVENTS,
    FORCE_REFERENCE,
    INPUTS,
    JOINT_STATE,
    LINKS,
    NUMERICAL_STATE,
    PLANT_STATE,
    SPEC,
    STRING,
    TIME_REFERENCE,
    link_topic,
)

if TYPE_CHECKING:
    from rthm_core.compiled import Integers

STATES = (PLANT_STATE, NUMERICAL_STATE, FORCE_REFERENCE, COMMAND, ENERGY, INPUTS, ACCELERATION)

T = TypeVar("T", Table, LinkTable)

LAST_REPORTS = 200
"""How many of the last messages on /diagnostics are read: counts run on, so the last ones say it all."""


def read_recording(path: str | Path, namespace: str | None = None) -> Recording:
    """Read a bag folder, or one .mcap or .db3 file, whole or cut off by a crash.

    Stamps of hosts whose clocks were compared are put on one clock where the ticks of the test are those of
    one clock (`synchronised.as_ticked`).

    Parameters
    ----------
    path : str or Path
        What `rthm run` or `ros2 bag record` wrote; compressed or not, with or without metadata.yaml.
    namespace : str, optional
        Which test to take when the bag holds several; by default the one with most samples of the plant.

    Raises
    ------
    InputError
        There is no bag, nothing in it can be read, or it has no samples of ``plant/state``.
    """
    bag = read_raw(path)
    namespace = _namespace(bag, path, namespace)
    tables, links = _tables(bag, namespace), _links(bag, namespace)
    if PLANT_STATE not in tables:
        reasons = " ".join(bag.notes)
        topic = f"{namespace}/{PLANT_STATE}"
        raise InputError(
            f"{path} has no message of {topic} that can be read: record it as {JOINT_STATE}. {reasons}"
        )
    span = _span(tables[PLANT_STATE].stamp_ns)
    tables = {name: _within(table, table.stamp_ns, span, name, bag) for name, table in tables.items()}
    links = {name: _within(link, link.use_ns, span, f"links/{name}", bag) for name, link in links.items()}
    text, spec = _spec(bag, namespace)
    start_ns = int(tables[PLANT_STATE].stamp_ns[0])
    present = {name: table for name, table in tables.items() if len(table)}
    used = {name: link for name, link in links.items() if len(link)}
    recording = Recording(
        Path(path),
        namespace,
        spec,
        text,
        present,
        used,
        start_ns,
        tuple(bag.notes),
        _diagnostics(bag, namespace),
        _clocks(bag, namespace),
        _events(bag, namespace),
    )
    return as_ticked(recording)


def _namespace(bag: RawBag, path: str | Path, wanted: str | None) -> str:
    """Namespace of the test: the `wanted` one, or the one with most samples of the plant."""
    ending = f"/{PLANT_STATE}"
    absolute = {f"/{name.lstrip('/')}": topic for name, topic in bag.topics.items()}
    sizes = {
        name.removesuffix(ending): len(topic) for name, topic in absolute.items() if name.endswith(ending)
    }
    if wanted is not None:
        wanted = f"/{wanted.strip('/')}".rstrip("/")
    if not sizes or (wanted is not None and wanted not in sizes):
        topics = ", ".join(sorted(filter(str.isprintable, bag.topics))[:12]) or "no other"
        raise InputError(
            f"{path} has no topic {wanted or ''}{ending} but {topics}: record it. {' '.join(bag.notes)}"
        )
    if len(sizes) > 1:
        bag.note(f"the bag holds {len(sizes)} tests, in {', '.join(name or '/' for name in sorted(sizes))}.")
    return max(sizes, key=lambda name: sizes[name]) if wanted is None else wanted


def _topic(bag: RawBag, namespace: str, name: str, message_type: str) -> RawTopic | None:
    topic = bag.topics.get(f"{namespace}/{name}") or bag.topics.get(f"{namespace}/{name}".lstrip("/"))
    if topic is not None and topic.type not in (message_type, message_type.replace("/msg/", "/"), ""):
        bag.note(f"{topic.name} has the type {topic.type!r}, not {message_type}: left out.")
        return None
    return topic if topic else None


def _tables(bag: RawBag, namespace: str) -> dict[str, Table]:
    tables = {}
    for name in STATES:
        if topic := _topic(bag, namespace, name, JOINT_STATE):
            table, notes = joint_table(topic)
            bag.notes += notes
            if len(table):
                tables[name] = table
    return tables


def _links(bag: RawBag, namespace: str) -> dict[str, LinkTable]:
    links = {}
    for name in LINKS:
        if topic := _topic(bag, namespace, link_topic(name), TIME_REFERENCE):
            link, notes = link_table(topic)
            bag.notes += notes
            if len(link):
                links[name] = link
    return links


def _span(stamps_ns: Integers) -> tuple[int, int]:
    """Bounds of stamps that can belong to a test with these samples; a damaged one may be decades away."""
    period = float(np.median(np.diff(stamps_ns))) if stamps_ns.size > 1 else 0.0
    middle, reach = int(stamps_ns[stamps_ns.size // 2]), int(10.0 * period * stamps_ns.size) + 10 * NS
    return middle - reach, middle + reach


def _within(table: T, times: Integers, span: tuple[int, int], name: str, bag: RawBag) -> T:
    inside = (times >= span[0]) & (times <= span[1])
    if not inside.all():
        strays = int(np.count_nonzero(~inside))
        bag.note(f"{name}: {strays} messages have stamps far away from the rest of the test: left out.")
    return table.rows(np.flatnonzero(inside))


def _spec(bag: RawBag, namespace: str) -> tuple[str, Spec | None]:
    """Text and value of the newest spec, of this namespace or the only one."""
    topic = _topic(bag, namespace, SPEC, STRING)
    if topic is None:
        bag.note(f"{ABSENT} {namespace}/{SPEC}.")
        return "", None
    try:
        text = decode_string(next(topic.last_messages(1)))
        return text, read_spec(text)
    except (InputError, ValueError) as reason:
        bag.note(f"{UNUSABLE}: {reason}")
        return "", None


def _clocks(bag: RawBag, namespace: str) -> HostClocks:
    topic = _topic(bag, namespace, CLOCKS, JOINT_STATE)
    return host_clocks(joint_table(topic)[0] if topic else None)


def _events(bag: RawBag, namespace: str) -> tuple[dict[str, Any], ...]:
    """Everything that was published on ``events``."""
    topic = _topic(bag, namespace, EVENTS, STRING)
    found = []
    for message in topic.last_messages(LAST_REPORTS) if topic else []:
        with suppress(ValueError):
            found.append(read_event(decode_string(message)))
    return tuple(event for event in found if event)


def _diagnostics(bag: RawBag, namespace: str) -> dict[str, dict[str, str]]:
    """Last status of each node of this test."""
    topic = bag.topics.get(DIAGNOSTICS)
    statuses: dict[str, dict[str, str]] = {}
    for message in topic.last_messages(LAST_REPORTS) if topic else []:
        with suppress(ValueError):
            statuses |= decode_diagnostics(message)
    return {name: values for name, values in statuses.items() if name.startswith(f"{namespace}/")}
