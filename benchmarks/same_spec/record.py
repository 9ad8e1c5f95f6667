"""The bag of a draw: by the node graph in simulated time, or of a plant alone by the engine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from benchmarks.rigs import virtual_bag
from benchmarks.same_spec.draw import DURATION, Draw

from rthm_analysis.energy.model import load_at
from rthm_analysis.exchange.bag import write_bag
from rthm_analysis.recording import Table, read_recording
from rthm_core.clock import to_ns
from rthm_core.engine import simulate
from rthm_core.spec import Spec

PLANT = "plant/state"


def bag_of(draw: Draw, spec: Spec, path: Path) -> Path:
    """Record a draw, without velocities where its rig has no such sensor; `path` is the spec as a file."""
    folder, text = path.parent / "bag", path.read_text(encoding="utf-8")
    if not draw.in_loop:
        write_bag(folder, {PLANT: _plant_alone(draw, spec)}, {}, text)
        return folder
    bag = virtual_bag(path, DURATION)
    if draw.velocity:
        return bag
    made = read_recording(bag)
    without = replace(made.plant, velocity=np.full_like(made.plant.velocity, np.nan))
    write_bag(folder, made.tables | {PLANT: without}, made.links, text)
    return folder


def _plant_alone(draw: Draw, spec: Spec) -> Table:
    """Position, velocity where it is measured, and the known force in `effort`."""
    run, rng = simulate(spec, DURATION, draw.td1, energies=False), np.random.default_rng(draw.seed)
    count = run.t.size
    stamps = np.arange(count) * to_ns(draw.td1)
    x = run.plant_position + spec.noise.position * rng.normal(size=(count, 1))
    v = run.plant_velocity + spec.noise.velocity * rng.normal(size=(count, 1))
    v = v if draw.velocity else np.full_like(v, np.nan)
    return Table(stamps, stamps, stamps, ("x1",), x, v, load_at(spec, stamps))
