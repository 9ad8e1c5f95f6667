"""The physical side as an object: what the plant node and the tests hold."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compensation import first_parts
from rthm_core.compiled import Floats
from rthm_core.kept import kept_without_timing
from rthm_core.physical.advance import (
    Physical,
    advance_and_sample,
    advance_to,
    command_and_advance,
)
from rthm_core.physical.model import PhysicalModel, Resting, physical_model
from rthm_core.physical.start import physical

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class PhysicalSample(NamedTuple):
    """What the data acquisition sees at one instant: motion of n dofs, known external loads, and m actuators.
    SI units.
    """

    position: Floats
    velocity: Floats
    load: Floats
    motor_position: Floats
    motor_velocity: Floats
    force: Floats


def first_command(spec: Spec) -> Floats:
    """Command (m,) in steady state before the test, in m."""
    if spec.actuator is None:
        return np.empty(0)
    position_part, force_part = first_parts(spec)
    return position_part + force_part


def build(spec: Spec) -> Physical:
    """Physical side of a spec at the start of a test."""
    return _at_start(spec, *physical_model(spec))


def read_only(spec: Spec) -> Physical:
    """The same, of a model that others have, too: to be read, not to be moved."""
    return _at_start(spec, *shared_model(spec))


@kept_without_timing
def shared_model(spec: Spec) -> tuple[PhysicalModel, list[Resting]]:
    """As `physical_model` gives it, made once for all that only read it."""
    return physical_model(spec)


def _at_start(spec: Spec, model: PhysicalModel, resting: list[Resting]) -> Physical:
    position, velocity = (
        np.array(spec.plant.initial_position, dtype=float),
        np.array(spec.plant.initial_velocity, dtype=float),
    )
    return physical(model, resting, position, velocity, first_command(spec))


class PhysicalSide:
    """Motor, wire and plant with the effects of the spec.

    All instants are ns since the start of the test. Commands and samples must come in the order of their
    instants.

    Parameters
    ----------
    spec : Spec
        Needs a plant; without actuator the plant moves under its known loads alone.

    Raises
    ------
    InputError
        When the spec has no plant, or actuators without an interface.
    """

    def __init__(self, spec: Spec) -> None:
        self.compiled = build(spec)
        n, m = self.dofs, self.actuators
        self._out = np.zeros(3 * n + 3 * m)
        self._ends = [0, n, 2 * n, 2 * n + m, 2 * n + 2 * m, 2 * n + 3 * m, 3 * n + 3 * m]

    @property
    def dofs(self) -> int:
        """Number n of degrees of freedom."""
        return int(self.compiled.model.n)

    @property
    def actuators(self) -> int:
        """Number m of actuators."""
        return int(self.compiled.model.m)

    @property
    def time_ns(self) -> int:
        """Instant to which the state belongs."""
        return int(self.compiled.state.time[0])

    def command(self, at_ns: int, u_d: Floats) -> None:
        """Make `u_d` (m,), in m, the input of the motors from `at_ns` on."""
        command_and_advance(self.compiled, at_ns, np.ascontiguousarray(u_d, dtype=float))

    def advance(self, to_ns: int) -> None:
        """Advance to an instant; an earlier one changes nothing."""
        advance_to(self.compiled, to_ns)

    def sample(self, stamp_ns: int) -> PhysicalSample:
        """Advance to `stamp_ns` and measure, with the noise and the sensor effects of the spec."""
        advance_and_sample(self.compiled, stamp_ns, self._out)
        out = self._out.copy()
        position, velocity, force, motor, motor_velocity, load = (
            out[begin:end] for begin, end in pairwise(self._ends)
        )
        return PhysicalSample(position, velocity, load, motor, motor_velocity, force)
