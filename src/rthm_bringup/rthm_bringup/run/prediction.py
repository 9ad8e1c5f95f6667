"""What the exact engine predicts of a test, beside its limits: looked at before anything moves."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from rthm_core.engine import Trajectory, simulate_blocks
from rthm_core.errors import InputError
from rthm_core.limits import limit_units
from rthm_core.spec import LimitsSpec, Spec
from rthm_core.substructure import interface

UNITS = limit_units("command", "rate", "force", "position", "velocity", "measured_force")
"""Limits that a prediction is compared with, and their units."""
ENDLESS = 600.0
"""How much of a test without end is predicted, s."""
BUDGET = 2.0
"""How long a prediction may take, s; of a longer one the rest of the test is not predicted."""


class Prediction(NamedTuple):
    """Largest values of a test.

    Attributes
    ----------
    values
        By the limit that each is for, in its unit; empty: nothing could be predicted.
    limits
        The limits of the test.
    seconds
        How much of the test is predicted, s.
    why
        Why nothing could be predicted, in a sentence.
    """

    values: Mapping[str, float]
    limits: LimitsSpec
    seconds: float = 0.0
    why: str = ""

    @property
    def allowed(self) -> dict[str, float]:
        """The limits that there are, of those that are predicted."""
        given = {name: getattr(self.limits, name) for name in self.values}
        return {name: limit for name, limit in given.items() if limit is not None}

    @property
    def beyond(self) -> list[str]:
        """Limits that the test will break."""
        return [name for name, limit in self.allowed.items() if not self.values[name] <= limit]

    @property
    def words(self) -> str:
        """What is predicted, in one line."""
        if not self.values:
            return f"the test could not be predicted, so its limits were not checked beforehand: {self.why}"
        return f"predicted for {self.seconds:g} s: {self._figures(self.allowed)}"

    @property
    def refusal(self) -> str:
        """Why the test must not begin; empty: it may."""
        if not self.beyond:
            return ""
        share = (
            math.floor(100.0 * min(self.allowed[name] / self.values[name] for name in self.beyond)) / 100.0
        )
        way = f"scale it with --amplitude {share:g}, " if share > 0.0 else ""
        return (
            "Nothing was moved, as the test is predicted to go beyond its limits:"
            f" {self._figures(self.beyond)}; {way}change the test, or raise the limits."
        )

    def as_dict(self) -> dict[str, dict[str, float | None]]:
        """Entry ``predicted`` of the JSON of ``rthm run``; a value that is not finite is None."""
        finite = {name: value if math.isfinite(value) else None for name, value in self.values.items()}
        return {name: {"value": finite[name], "allowed": limit} for name, limit in self.allowed.items()}

    def _figures(self, names: Collection[str]) -> str:
        return ", ".join(
            f"{name} {self.values[name]:.3g} of {limit:g} {UNITS[name]}"
            for name, limit in self.allowed.items()
            if name in names
        )


def predicted(spec: Spec, duration: float, budget: float = BUDGET) -> Prediction:
    """Predict a test.

    Parameters
    ----------
    spec
        A complete loop.
    duration
        Its length, s; 0: without end.
    budget
        Time after which no further stretch is begun, s.
    """
    limits, end = spec.limits or LimitsSpec(), float("inf")
    found, seconds = dict.fromkeys(UNITS, 0.0), 0.0
    try:
        for block, last in _stretches(spec, duration or ENDLESS):
            for name, value in largest(spec, block, last).items():
                found[name] = max(found[name], value) if np.isfinite(value) else np.inf
            seconds = float(block.t[-1])
            if time.monotonic() > end:
                break
            end = min(end, time.monotonic() + budget)  # from the first stretch on, which may be compiled
    except (InputError, ArithmeticError) as error:
        return Prediction({}, limits, why=str(error))
    return Prediction(found, limits, seconds)


def largest(spec: Spec, block: Trajectory, before: np.ndarray | None = None) -> dict[str, float]:
    """Largest values in a stretch of a trajectory with a row every Td3, by the limit that each is for.

    Parameters
    ----------
    before
        Positions (m,) of the motors one row before the stretch, m; None: it is the first one.
    """
    motors = motor_positions(spec, block)
    moved = motors if before is None else np.vstack([before, motors])
    steps = np.abs(np.diff(moved, axis=0)).max(initial=0.0)
    pull = float(np.abs(block.actuator_force).max())
    return {
        "command": float(np.abs(motors).max()),
        "rate": float(steps) / spec.loop().timing.td3,
        "force": max(pull, float(np.abs(block.force_reference).max())),
        "position": float(np.abs(block.plant_position).max()),
        "velocity": float(np.abs(block.plant_velocity).max()),
        "measured_force": pull,
    }


def motor_positions(spec: Spec, block: Trajectory) -> np.ndarray:
    """Positions (rows, m) of the motors at the other ends of the wires, m."""
    ends = block.plant_position[:, interface(spec).plant]
    return np.asarray(ends + block.actuator_force / np.array(spec.k_tot))


def _stretches(spec: Spec, duration: float) -> Iterator[tuple[Trajectory, np.ndarray | None]]:
    """Stretches of the trajectory, each with where the motors were before."""
    before = None
    for block in simulate_blocks(spec, duration, spec.loop().timing.td3, energies=False):
        yield block, before
        before = motor_positions(spec, block)[-1]
