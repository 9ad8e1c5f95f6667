"""Limits of a test, and how near it is to each."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.dashboard.digits import rounded
from rthm_analysis.dashboard.fresh import Fresh
from rthm_analysis.recording.table import hold
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.limits import kept_limits, limit_units
from rthm_core.topics import COMMAND, DRY_COMMAND, PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


class Nearness:
    """Readings of a test beside its limits.

    Parameters
    ----------
    spec : Spec
        A loop.
    hardware : bool
        Whether the plant is a real machine: then limits have defaults.
    """

    def __init__(self, spec: Spec, hardware: bool) -> None:
        loop = spec.loop()
        self._dofs, self._motors = loop.plant.dofs, loop.actuator.names
        self._readings: dict[str, Callable[[Fresh], float]] = {
            "command": lambda fresh: _largest(self._command(fresh, "position")),
            "rate": self._rate,
            "force": lambda fresh: _largest(self._command(fresh, "effort")),
            "position": lambda fresh: _largest(fresh.columns(PLANT_STATE, "position", self._dofs)),
            "velocity": lambda fresh: _largest(fresh.columns(PLANT_STATE, "velocity", self._dofs)),
            "measured_force": lambda fresh: _largest(fresh.columns(PLANT_STATE, "effort", self._motors)),
            "step": lambda fresh: _largest(
                np.diff(fresh.columns(PLANT_STATE, "position", self._dofs), axis=0)
            ),
            "following": self._following,
            "age": lambda fresh: max(_age(fresh, "tau1"), _age(fresh, "tau3")),
            "command_age": lambda fresh: _age(fresh, "tau4"),
            "clock": lambda fresh: _largest(_all_positions(fresh, "clocks")),
        }
        self._allowed = _allowed(spec, hardware, list(self._readings))
        self._peak = dict.fromkeys(self._allowed, 0.0)
        self._now = dict.fromkeys(self._allowed, 0.0)

    def add(self, fresh: Fresh) -> None:
        """Read what has come."""
        for name in self._allowed:
            self._now[name] = self._readings[name](fresh)
            self._peak[name] = max(self._peak[name], self._now[name])

    def told(self) -> list[dict[str, Any]]:
        """Of every limit: reading now, largest reading of the test, what is allowed, unit."""
        units = limit_units(*self._allowed)
        return [
            {
                "name": name,
                "now": rounded(self._now[name]),
                "peak": rounded(self._peak[name]),
                "allowed": allowed,
                "unit": units[name],
            }
            for name, allowed in self._allowed.items()
        ]

    def _command(self, fresh: Fresh, field: str) -> Floats:
        return fresh.columns(_commands(fresh), field, self._motors)

    def _rate(self, fresh: Fresh) -> float:
        between = np.diff(fresh.stamps(_commands(fresh))) / NS
        steps = np.abs(np.diff(self._command(fresh, "position"), axis=0))
        apart = between > 0.0
        return _largest(steps[apart] / between[apart, None])

    def _following(self, fresh: Fresh) -> float:
        """Distance of the motors from the command that was sent last."""
        motors, sent = (
            fresh.columns(PLANT_STATE, "position", self._motors),
            self._command(fresh, "position"),
        )
        if not len(sent):
            return 0.0
        return _largest(motors - hold(fresh.stamps(_commands(fresh)), sent, fresh.stamps(PLANT_STATE)))


def _allowed(spec: Spec, hardware: bool, names: list[str]) -> dict[str, float]:
    try:
        limits = kept_limits(spec, hardware)
    except InputError:  # a limit that is compulsory is missing: such a test does not begin
        limits = kept_limits(spec, False)
    given = {name: getattr(limits, name) for name in names}
    return {name: float(value) for name, value in given.items() if value is not None}


def _commands(fresh: Fresh) -> str:
    return COMMAND if COMMAND in fresh.tables else DRY_COMMAND


def _largest(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.abs(known).max(initial=0.0))


def _all_positions(fresh: Fresh, topic: str) -> Floats:
    table = fresh.tables.get(topic)
    return np.empty(0) if table is None else table.position


def _age(fresh: Fresh, link: str) -> float:
    table = fresh.links.get(link)
    return 0.0 if table is None else float((table.use_ns - table.sample_ns).max(initial=0)) / NS
