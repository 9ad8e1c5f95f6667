"""Which column of a file is which signal, in which unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from rthm_core.errors import InputError, refusal, shown
from rthm_core.spec import Spec
from rthm_core.topics import ACCELERATION, INPUTS, PLANT_STATE


class Role(NamedTuple):
    """Where values of a signal go: SI unit, field of JointState, whether its name is a dof's, and topic."""

    unit: str
    field: str
    of_dof: bool
    topic: str = PLANT_STATE


ROLES = {
    "position": Role("m", "position", True),
    "velocity": Role("m/s", "velocity", True),
    "acceleration": Role("m/s^2", "effort", True, ACCELERATION),
    "load": Role("N", "effort", True),
    "force": Role("N", "effort", False),
    "motor": Role("m", "position", False),
    "input": Role("1", "effort", False, INPUTS),
}
"""`load` is a known external force on a dof, `force` what an actuator or a known drive exerts; `input` is
anything else that was set, as the voltage of a damper, in a unit of its own.
"""

USUAL = {True: "x1", False: "a1"}
"""Names of a dof and of an actuator where neither the user nor a spec gives one."""

USUAL_INPUT = "u1"
"""Name of an input where the user gives none."""


@dataclass(frozen=True)
class Signal:
    """One signal of the plant and the column that has it."""

    role: str
    name: str
    column: str


@dataclass(frozen=True)
class Wanted:
    """What a user says about a file.

    Attributes
    ----------
    signals : tuple of Signal
    units : dict of str
        By role, ``role:name``, or ``time``; they overrule what the file says.
    time : str or None
        Column of the time.
    rate : float or None
        Samples per second, where there is no such column.
    offsets : dict of float
        By role or ``role:name``: the reading, in the unit of the file, where the signal is zero.
    """

    signals: tuple[Signal, ...] = ()
    units: dict[str, str] = field(default_factory=dict)
    time: str | None = None
    rate: float | None = None
    offsets: dict[str, float] = field(default_factory=dict)

    def unit_of(self, one: Signal) -> str | None:
        """Unit that the user gives a signal, or all of its role."""
        return self.units.get(f"{one.role}:{one.name}") or self.units.get(one.role)

    def offset_of(self, one: Signal) -> float:
        """Reading, in the unit of the file, where a signal is zero."""
        return self.offsets.get(f"{one.role}:{one.name}", self.offsets.get(one.role, 0.0))


def wanted(
    maps: Sequence[str],
    units: Sequence[str] = (),
    time: str | None = None,
    rate: float | None = None,
    spec: Spec | None = None,
    offsets: Sequence[str] = (),
) -> Wanted:
    """Read what a user says: ``position:x1=COLUMN``, ``position=mm`` and ``position:x1=512``.

    Raises
    ------
    InputError
        Something in it has another form, names a role that is not known, or names what the spec has not.
    """
    signals = tuple(_signal(text, spec) for text in maps)
    places = [(ROLES[one.role].topic, ROLES[one.role].field, one.name) for one in signals]
    for one, place in zip(signals, places, strict=True):
        if places.count(place) > 1:
            raise InputError(f"{one.role} of {one.name} is mapped twice; give it once.")
    if rate is not None and not 1e-6 <= rate <= 1e7:
        raise refusal("--rate", rate, "from 1e-6 to 1e7 Hz")
    if rate is not None and time is not None:
        raise InputError(f"--time {time} and --rate {rate:g} are both given; give the one that is right.")
    return Wanted(
        signals, dict(_unit(text) for text in units), time, rate, dict(_offset(text) for text in offsets)
    )


def _signal(text: str, spec: Spec | None) -> Signal:
    left, sign, column = text.partition("=")
    role, _, name = left.partition(":")
    if not sign or not column or role not in ROLES:
        raise InputError(
            f"--map {shown(text)} must be ROLE:NAME=COLUMN, as position:x1=y, with one of the roles "
            f"{', '.join(ROLES)}; correct it."
        )
    if role == "input":
        return Signal(role, name or USUAL_INPUT, column)
    of_dof = ROLES[role].of_dof
    known = _names(spec, of_dof)
    name = name or (known[0] if known else USUAL[of_dof])
    if known and name not in known:
        raise InputError(f"--map {shown(text)} names {name}, but the spec has {', '.join(known)}; take one.")
    dofs = spec.plant.dofs if spec and spec.plant else ()
    if role == "force" and not known and len(dofs) > 1:
        raise InputError(
            f"--map {shown(text)}: the spec has several dofs and no actuator; say on which one the force "
            f"acts, as load:{dofs[0]}={column}."
        )
    if not of_dof and name in dofs:
        raise InputError(
            f"--map {shown(text)} gives a dof the role {role}; write load:{name} for a force on it."
        )
    return Signal(role, name, column)


def _names(spec: Spec | None, of_dof: bool) -> tuple[str, ...]:
    """Names that a spec allows; none: any."""
    if spec is None:
        return ()
    if of_dof:
        return spec.plant.dofs if spec.plant else ()
    return spec.actuator.names if spec.actuator else ()


def _unit(text: str) -> tuple[str, str]:
    left, sign, unit = text.partition("=")
    role = left.partition(":")[0]
    if not sign or not unit or (role not in ROLES and left != "time"):
        raise InputError(
            f"--unit {shown(text)} must be ROLE=UNIT or ROLE:NAME=UNIT, as position=mm, with one of the "
            f"roles time, {', '.join(ROLES)}; correct it."
        )
    return left, unit


def _offset(text: str) -> tuple[str, float]:
    left, _, number = text.partition("=")
    try:
        value = float(number)
    except ValueError:
        value = float("nan")
    if left.partition(":")[0] not in ROLES or not abs(value) < float("inf"):
        raise InputError(
            f"--offset {shown(text)} must be ROLE=NUMBER or ROLE:NAME=NUMBER, as position:x1=512, with one "
            f"of the roles {', '.join(ROLES)} and the reading where it is zero; correct it."
        )
    return left, value
