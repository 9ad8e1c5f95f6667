"""The two messages of the loop as prepared bytes.

A message of one topic has the same bytes every time but for its stamps and numbers. So they are packed into a
prepared frame, several times faster than a message object is serialised, and the padding between them is
always zero, so that equal samples are equal bytes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from struct import Struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rthm_core.clock import NS
from rthm_core.ros.cdr import ENCAPSULATION, Walk, array_layout, end_of_array, string, strings

FIELDS = ("position", "velocity", "effort")
"""Arrays of a JointState, in order."""

Array = NDArray[np.float64]


class JointSample(NamedTuple):
    """One JointState, in the receiver's order of names.

    Attributes
    ----------
    stamp
        Instant to which the values belong, ns.
    position, velocity, effort
        One value per name, NaN where the message has none.
    """

    stamp: int
    position: list[float]
    velocity: list[float]
    effort: list[float]


class JointStateWriter:
    """Bytes of a ``sensor_msgs/JointState`` with fixed names.

    Parameters
    ----------
    names
        Names of the joints: dofs and actuators.
    fields
        Which of ``position``, ``velocity``, ``effort`` the message has; the others are empty arrays.
    """

    def __init__(self, names: Sequence[str], fields: Sequence[str] = FIELDS) -> None:
        head = string("") + strings(names, at=8 + len(string("")))
        self._counts = [len(names) if field in fields else 0 for field in FIELDS]
        layout, at = f"<4siI{len(head)}s", 8 + len(head)
        for count in self._counts:
            layout, at = layout + array_layout(at, count), end_of_array(at, count)
        self._pack = Struct(layout).pack
        self._head = head

    def bytes(self, stamp: int, *fields: Sequence[float] | Array) -> bytes:
        """Message with this stamp (ns) and the values of its fields, in order."""
        values: list[float] = []
        given = iter(fields)
        for count in self._counts:
            values.append(count)
            if count:
                field = next(given)
                values.extend(field.tolist() if isinstance(field, np.ndarray) else field)
        return self._pack(ENCAPSULATION, *divmod(stamp, NS), self._head, *values)


class JointStateReader:
    """Values of JointState messages, whoever sent them, in the order of `names`.

    Messages of one sender differ in nothing but stamps and numbers, so where these lie is worked out once.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._names = tuple(names)
        self._known = (-1, b"")
        self._stamp = Struct("<iI")
        self._numbers = Struct("")
        self._at = 0
        self._places: list[list[int]] = []

    def sample(self, data: bytes) -> JointSample:
        """Read one message.

        Raises
        ------
        ValueError
            If the message is cut short or does not name what the receiver needs.
        """
        if (len(data), data[12 : self._at]) != self._known:
            self._learn(data)
        seconds, nanoseconds = self._stamp.unpack_from(data, 4)
        numbers = (*self._numbers.unpack_from(data, self._at), math.nan)
        position, velocity, effort = ([numbers[i] for i in places] for places in self._places)
        return JointSample(seconds * NS + nanoseconds, position, velocity, effort)

    def _learn(self, data: bytes) -> None:
        walk = Walk(data)
        walk.at += 8
        walk.string()
        names = [walk.string() for _ in range(walk.count())]
        chosen = [_place(names, name) for name in self._names]
        self._at, layout, counts = walk.at, walk.order, []
        for _ in range(3):
            start = walk.at
            counts.append(walk.doubles())
            if counts[-1] not in (0, len(names)):
                raise ValueError(f"has {counts[-1]} values for {len(names)} names")
            layout += array_layout(start - 4, counts[-1])
        self._stamp, self._numbers = Struct(walk.order + "iI"), Struct(layout)
        self._places = _places(counts, chosen)
        self._known = (len(data), data[12 : self._at])


class TimeReferenceWriter:
    """Bytes of a ``sensor_msgs/TimeReference`` of one link."""

    def __init__(self, source: str) -> None:
        frame = string("")
        pad = -(8 + len(frame)) % 4
        self._frame = frame + bytes(pad)
        self._source = string(source)
        self._pack = Struct(f"<4siI{len(self._frame)}siI{len(self._source)}s").pack

    def bytes(self, stamp: int, reference: int) -> bytes:
        """Message: a sample stamped `reference` was used at `stamp` (both ns)."""
        return self._pack(
            ENCAPSULATION, *divmod(stamp, NS), self._frame, *divmod(reference, NS), self._source
        )


def _place(names: list[str], name: str) -> int:
    if name not in names:
        raise ValueError(f"names {', '.join(names) or 'nothing'}, but not {name}")
    return names.index(name)


def _places(counts: list[int], chosen: list[int]) -> list[list[int]]:
    """Where each chosen value stands among all numbers: each array comes after its count, NaN is last."""
    places, before = [], 0
    for count in counts:
        places.append([before + 1 + i if count else -1 for i in chosen])
        before += 1 + count
    return places
