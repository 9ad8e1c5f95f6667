"""`sensitivities`: how a trajectory changes with the parameters of its spec."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from rthm_core.clock import to_ns
from rthm_core.engine.linear.blocks import Rows
from rthm_core.engine.simulate import checked_step, simulate
from rthm_core.engine.tangents.changes import stencil
from rthm_core.engine.tangents.run import prepared, run
from rthm_core.engine.trajectory import Trajectory, of_rows
from rthm_core.errors import InputError
from rthm_core.kept import kept
from rthm_core.spec import parameters

if TYPE_CHECKING:
    from rthm_core.spec import EffectSpec, Spec

PHYSICAL = ("plant", "numerical", "interface", "actuator.stiffness", "actuator.motor_poles", "load")
"""Sections whose numbers are parameters of the physics, beside those of the effects."""

INITIAL = ("initial_position", "initial_velocity")
"""Numbers of a substructure that are no property of it."""

SIGNALS = tuple(one.name for one in fields(Trajectory) if one.name not in ("t", "energies"))
"""Arrays of a trajectory that have derivatives."""

NOT_SMOOTH = ("timing", "noise", "uncertainty", "limits", "actuator.compensator_order")
"""Sections on which no trajectory depends smoothly: clocks count in ns; what is random or rounded jumps."""


@dataclass
class Sensitivities:
    """A trajectory and its derivatives.

    Attributes
    ----------
    trajectory : Trajectory
    by_parameter : dict of Trajectory
        Derivative of each of its arrays with respect to one parameter, in SI units over the parameter's;
        `t` is the time of the rows.
    tangents : bool
        Whether they were computed beside the trajectory, or by differences of whole simulations, which is
        what remains where laws have mass or depend on a load or on instants, wires have kinks, or samples are
        noisy.
    """

    trajectory: Trajectory
    by_parameter: dict[str, Trajectory]
    tangents: bool


def sensitivities(
    spec: Spec,
    duration: float,
    names: Sequence[str] | None = None,
    sample: float | None = None,
    *,
    energies: bool = True,
) -> Sensitivities:
    """Simulate a loop exactly, and how it changes with parameters.

    Parameters
    ----------
    spec : Spec
        A loop.
    duration : float
        Length in s.
    names : sequence of str, optional
        Dotted names of numbers, as in `apply`; every one of the physics when absent.
    sample : float, optional
        Distance of the rows in s; Td1 when absent.
    energies : bool
        Whether the work of the trajectory is counted; it has no derivatives.

    Raises
    ------
    InputError
        When the spec is no loop, duration or sample is not a positive number, or a name is not that of a
        number on which the motion depends smoothly.
    """
    step = checked_step(spec, duration, sample)
    spec.loop()
    chosen = physical_numbers(spec) if names is None else _checked(spec, tuple(names))
    beside = _beside(spec, chosen, to_ns(duration), step, energies=energies)
    if beside is not None:
        return beside
    trajectory = simulate(spec, duration, step * 1e-9, energies=energies)
    by_parameter = {name: _difference(spec, name, duration, step * 1e-9) for name in chosen}
    return Sensitivities(trajectory, by_parameter, tangents=False)


@kept
def physical_numbers(spec: Spec) -> tuple[str, ...]:
    """Names of all numbers of the physics that are not zero: properties of both sides and of what joins
    them, of loads and of effects.
    """
    sections = (*PHYSICAL, *(one.name for one in spec.effects if not _shifts_time(one)))
    found: list[str] = []
    for one in parameters(spec):
        initial = one.name.endswith(INITIAL)
        if initial or not _within(one.name, sections) or not one.type.startswith("double"):
            continue
        values = one.value if isinstance(one.value, list) else [one.value]
        single = len(values) == 1
        found += [one.name if single else f"{one.name}[{i}]" for i, value in enumerate(values) if value]
    return tuple(found)


def _within(name: str, sections: Sequence[str]) -> bool:
    """Whether a dotted name is one of some entries or stands in one of some sections."""
    return any(f"{name.partition('[')[0]}.".startswith(f"{section}.") for section in sections)


def _shifts_time(one: EffectSpec) -> bool:
    """Whether an effect decides when something happens, which is an instant in ns."""
    return one.block.startswith("link") or one.law.changes == "delay"


@kept
def _checked(spec: Spec, names: tuple[str, ...]) -> tuple[str, ...]:
    """The names; refuses those on which no motion depends smoothly."""
    refused = (*NOT_SMOOTH, *(one.name for one in spec.effects if _shifts_time(one)))
    for name in names:
        if _within(name, refused):
            raise InputError(
                f"{name} is nothing on which a motion depends smoothly, allowed are numbers of the plant, "
                f"the numerical side, the interface, the actuators, loads and effects; leave it out."
            )
    return names


def _beside(
    spec: Spec, names: tuple[str, ...], end: int, step: int, *, energies: bool
) -> Sensitivities | None:
    """Sensitivities by tangents; None where there are none."""
    one = prepared(spec, names, step, energies)
    found = None if one is None else run(spec, one, end, step, energies=energies)
    if one is None or found is None:
        return None
    (beside, work), m, n = found, one.loop.linear.k_tot.size, one.loop.linear.numerical.y.size
    plant = beside.shape[1] - n - m
    parts = beside[:, :plant], beside[:, plant : plant + n], beside[:, plant + n :]
    every = of_rows(spec, Rows(*parts, work), step)
    by_parameter = {
        name: _of_one(every, place) for name, place in zip(names, one.placement.places.tolist(), strict=True)
    }
    motion = _of_one(every, -1)
    motion.energies = every.energies
    return Sensitivities(motion, by_parameter, tangents=True)


def _of_one(every: Trajectory, place: int) -> Trajectory:
    """Tangents for one parameter, or last the motion; all have the parameters along their last axis."""
    return Trajectory(every.t, **{name: getattr(every, name)[..., place] for name in SIGNALS})


def _difference(spec: Spec, name: str, duration: float, sample: float) -> Trajectory:
    """Derivative of a trajectory by simulating neighbours of its spec."""
    weighted = [
        (weight, simulate(beside, duration, sample, energies=False)) for beside, weight in stencil(spec, name)
    ]
    arrays = {
        name: sum(weight * getattr(trajectory, name) for weight, trajectory in weighted) for name in SIGNALS
    }
    return Trajectory(weighted[0][1].t, **arrays)
