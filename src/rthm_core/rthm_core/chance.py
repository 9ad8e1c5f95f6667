"""Random numbers that are a pure function of (seed, stream, stamp).

Noise and jitter belong to a sample, not to the process that happens to draw them. Keyed by the sample's
stamp, the exact engine, a virtual
run and a node on another host draw the same value for the same sample, in any order and after any loss.
"""

from __future__ import annotations

import hashlib
import math

import numpy as np

from rthm_core.compiled import Floats, Integers, compiled, inlined

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_TWO_TO_MINUS_53 = 2.0**-53


def stream_key(seed: int, stream: str) -> np.uint64:
    """Key of a named stream of random numbers, e.g. ``(spec.noise.seed, "position.x1")``."""
    digest = hashlib.blake2b(f"{seed}/{stream}".encode(), digest_size=8).digest()
    return np.uint64(int.from_bytes(digest, "little"))


@inlined
def _mixed(z):  # type: ignore[no-untyped-def]
    """Output function of splitmix64 (Steele, Lea, Flood 2014)."""
    z = (z ^ (z >> np.uint64(30))) * _FIRST
    z = (z ^ (z >> np.uint64(27))) * _SECOND
    return z ^ (z >> np.uint64(31))


@inlined
def _uniform_at(key, stamp, draw):  # type: ignore[no-untyped-def]
    z = _mixed(key + np.uint64(stamp) * _GOLDEN)
    z = _mixed(z + np.uint64(draw + 1) * _GOLDEN)
    return (np.float64(z >> np.uint64(11)) + 0.5) * _TWO_TO_MINUS_53


@inlined
def normal_at(key, stamp):  # type: ignore[no-untyped-def]
    """One standard normal number of stream `key` for the sample stamped `stamp` (ns), by Box and Muller."""
    radius = math.sqrt(-2.0 * math.log(_uniform_at(key, stamp, 0)))
    return radius * math.cos(2.0 * math.pi * _uniform_at(key, stamp, 1))


@compiled
def _uniforms(key: np.uint64, stamps: Integers) -> Floats:
    values = np.empty(stamps.size)
    for i in range(stamps.size):
        values[i] = _uniform_at(key, stamps[i], 2)
    return values


@compiled
def _normals(key: np.uint64, stamps: Integers) -> Floats:
    values = np.empty(stamps.size)
    for i in range(stamps.size):
        values[i] = normal_at(key, stamps[i])
    return values


def uniform(seed: int, stream: str, stamps_ns: Integers) -> Floats:
    """Numbers in (0, 1), one for each stamp; shape of `stamps_ns`."""
    stamps = np.atleast_1d(np.asarray(stamps_ns, dtype=np.int64))
    return _uniforms(stream_key(seed, stream), stamps)


def normal(seed: int, stream: str, stamps_ns: Integers) -> Floats:
    """Standard normal numbers, one for each stamp; shape of `stamps_ns`; never beyond 8.7 in size."""
    stamps = np.atleast_1d(np.asarray(stamps_ns, dtype=np.int64))
    return _normals(stream_key(seed, stream), stamps)
