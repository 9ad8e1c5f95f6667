"""One case: a rig, maybe an effect at a place, and the bag of what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
import yaml
from benchmarks.concealed.bag import STORE, joint_states
from benchmarks.two_dofs.laws import MAKERS
from benchmarks.two_dofs.rig import (
    COMMAND_EVERY,
    NOISE,
    STEP,
    Rig,
    Run,
    draw_rig,
    scale_at,
    simulate,
    spec_of,
    visibility,
)
from rosbags.rosbag2 import StoragePlugin, Writer

SHARES = (0.04, 0.15)
"""Force of an effect, as a part of that of the spring at its place."""

SEEN = (5.0, 400.0)
"""Difference that it makes, over the noise: an effect below is drawn larger, one above smaller."""


@dataclass(frozen=True)
class Case:
    """What a diagnosis gets, and what it does not."""

    bag: Path
    spec: Path
    kind: str
    place: str
    parameters: dict[str, float]
    visibility: float


def make_case(seed: int, place: str, *, motors: bool, folder: Path) -> Case:
    """Make a case; at no place (``""``) nothing is missing."""
    rng = np.random.default_rng(seed)
    rig = draw_rig(rng, motors=motors)
    run, kind, parameters, seen = simulate(rig), "", {}, 0.0
    if place:
        maker, plain = MAKERS[rng.integers(len(MAKERS))], run
        share, state = float(rng.uniform(*SHARES)), rng.bit_generator.state
        for _ in range(6):
            rng.bit_generator.state = state
            law = maker(share, scale_at(rig, plain, place), rng)
            run = simulate(rig, law, place)
            kind, parameters, seen = law.kind, law.parameters, visibility(plain, run, motors=motors)
            if SEEN[0] <= seen <= SEEN[1]:
                break
            share *= 2.0 if seen < SEEN[0] else 0.5
    told = folder / "spec.yaml"
    told.write_text(yaml.safe_dump({"/**": {"ros__parameters": spec_of(rig)}}), encoding="utf-8")
    bag = _write(folder / "bag", rig, run, told.read_text(encoding="utf-8"), rng)
    return Case(bag, told, kind, place, parameters, seen)


def _write(folder: Path, rig: Rig, run: Run, text: str, rng: np.random.Generator) -> Path:
    start = 1_700_000_000 * 10**9
    stamps = start + np.arange(run.x.shape[0], dtype=np.int64) * round(STEP * 1e9)
    topics = [("plant/state", stamps, _joint_states(stamps, rig, run, rng))]
    if rig.has_motors:
        every = slice(None, None, COMMAND_EVERY)
        known = joint_states(stamps[every], ["a1", "a2"], position=run.drive[every])
        topics.append(("actuator/command", stamps[every], known))
    said = STORE.types["std_msgs/msg/String"](data=text)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        spec = writer.add_connection("/rthm/spec", said.__msgtype__, typestore=STORE)
        writer.write(spec, start, STORE.serialize_cdr(said, said.__msgtype__))
        kind = "sensor_msgs/msg/JointState"
        opened = [writer.add_connection(f"/rthm/{name}", kind, typestore=STORE) for name, _, _ in topics]
        rows = chain.from_iterable(
            zip(times, [to] * times.size, payloads, strict=True)
            for to, (_, times, payloads) in zip(opened, topics, strict=True)
        )
        for stamp, to, payload in sorted(rows, key=lambda row: row[0]):
            writer.write(to, int(stamp), payload)
    return folder


def _joint_states(stamps: np.ndarray, rig: Rig, run: Run, rng: np.random.Generator) -> list[bytes]:
    """What the sensors read."""

    def read(signal: np.ndarray, family: str) -> np.ndarray:
        return np.asarray(signal + rng.normal(0.0, NOISE[family], signal.shape))

    x, v, none = read(run.x, "position"), read(run.v, "velocity"), np.full_like(run.v, np.nan)
    if not rig.has_motors:
        return joint_states(stamps, ["x1", "x2"], position=x, velocity=v, effort=run.drive)
    return joint_states(
        stamps,
        ["x1", "x2", "a1", "a2"],
        position=np.hstack([x, read(run.motor, "motor")]),
        velocity=np.hstack([v, none]),
        effort=np.hstack([np.zeros_like(x), read(run.force, "force")]),
    )
