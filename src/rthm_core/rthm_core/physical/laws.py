"""The laws of a spec as tables of numbers, and the compiled functions that call a law by its number."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numba.core.errors import NumbaError

from rthm_core.addressed import Call, law_function, table_of
from rthm_core.compiled import Floats, Integers
from rthm_core.effects.laws import MOST_PARAMETERS, PlantLaw, WireLaw, has_coupling, has_inertia
from rthm_core.effects.registry import changing
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import EffectSpec

PLANT_CALLS = {
    "force": Call("x, v, z, t, p, mode", True),
    "rate": Call("x, v, z, t, p, mode, dz", False),
    "inertia": Call("x, v, z, t, p, mode", True),
    "coupling": Call("x, y, p", True),
    "coupling_by_x": Call("x, y, p", True),
    "coupling_by_y": Call("x, y, p", True),
}
WIRE_CALLS = {
    "settle": Call("u, x, k, z, p", False),
    "drive": Call("u, z, p", True),
    "force": Call("u, x, v, k, f, z, p", True),
    "rate": Call("u, x, v, k, z, p, dz", False),
}
"""Functions of a law that are compiled, and how they are called; in the order of the slots of a table."""

PARTITIONS = ("none", "position", "velocity", "friction", "time")
NONE, POSITION, VELOCITY, FRICTION, TIME = range(5)
"""How the modes of a law meet; indices into `PARTITIONS`."""


plant_force = law_function(PLANT_CALLS, "force")
plant_rate = law_function(PLANT_CALLS, "rate", PlantLaw.rate)
plant_inertia = law_function(PLANT_CALLS, "inertia", PlantLaw.inertia)
plant_coupling = law_function(PLANT_CALLS, "coupling", PlantLaw.coupling)
plant_coupling_by_x = law_function(PLANT_CALLS, "coupling_by_x", PlantLaw.coupling_by_x)
plant_coupling_by_y = law_function(PLANT_CALLS, "coupling_by_y", PlantLaw.coupling_by_y)
wire_settle, wire_drive, wire_law_force, wire_rate = (
    law_function(WIRE_CALLS, name, getattr(WireLaw, name)) for name in WIRE_CALLS
)


class Masses(NamedTuple):
    """Laws by which mass moves with the dofs beside the plant's own.

    Attributes
    ----------
    rows : (H,) array
        Rows of laws with inertia.
    coupled : (C,) array or None
        Rows of laws that couple two dofs; None where there are none, so that nothing of it is compiled.
    plant : (n, n) array
        The plant's own mass, kg.
    inverse : (n, n) array
        Inverse of all mass, when a rate was last computed, 1/kg.
    """

    rows: Integers
    coupled: Integers | None
    plant: Floats
    inverse: Floats


class LawTable(NamedTuple):
    """Nonlinear laws on the plant: L rows.

    Columns of `numbers` are code, dof, first own state, number of own states, how the modes meet, which load
    the law depends on (-1: none), and the dof relative to which the first moves (-1: none);
    `parameters` (L, 8), `thresholds` (L, 2);
    `breakaway` (L,) in N; `heavy` is None where no law has mass, so that nothing of it is compiled.
    """

    numbers: Integers
    parameters: Floats
    thresholds: Floats
    breakaway: Floats
    heavy: Masses | None


class WireTable(NamedTuple):
    """Wires of m actuators, and the laws of those that are not linear (W rows, sorted from motor to plant
    within an actuator).

    Attributes
    ----------
    numbers : (m, 3) array
        Plant dof, first state of the pulley of (3a) or -1, whether the wire is nonlinear.
    stiffness : (m, 2) array
        Of the wire itself and k_tot, N/m.
    drive, force : (m, ny + m) arrays
        Drive side of the wire (motor or pulley), and force of a linear wire, from [y, u].
    laws : (W, 5) array
        Code, actuator, first own state, number of own states, whether it lets the wire go slack.
    parameters : (W, 8) array
        Of the laws.
    paths : (W, 2) array
        Shares of the drive side and of the dof in the path that a law remembers.
    """

    numbers: Integers
    stiffness: Floats
    drive: Floats
    force: Floats
    laws: Integers
    parameters: Floats
    paths: Floats

    def sized(self, size: int) -> WireTable:
        """The table with rows for `size` states."""
        m = self.numbers.shape[0]
        drive = np.zeros((m, size + m))
        for actuator, (_, pulley, _) in enumerate(self.numbers):
            drive[actuator, pulley if pulley >= 0 else size + actuator] = 1.0
        return self._replace(drive=drive, force=np.zeros((m, size + m)))


CODE, PLACE, STATE, STATES, PARTITION, LOADED, OTHER = range(7)
"""Columns of the tables of laws; the place is a dof or an actuator, the code as `code_of` gives it."""

SLACKENS = PARTITION
"""Column of ``WireTable.laws`` in which plant laws have how their modes meet."""

DOF, PULLEY, NONLINEAR = range(3)
"""Columns of ``WireTable.numbers``."""


_LAWS: dict[int, Any] = {}
"""Laws by code."""


@cache
def code_of(law: Any) -> int:
    """Number by which compiled code knows a law: the address of a table of its functions, which are compiled
    here or read from the disk. It is another one in every process.

    Raises
    ------
    InputError
        If they cannot be compiled.
    """
    base, calls = (PlantLaw, PLANT_CALLS) if issubclass(law, PlantLaw) else (WireLaw, WIRE_CALLS)
    functions = {name: getattr(law, name) for name in calls}
    own = [None if function is getattr(base, name) else function for name, function in functions.items()]
    try:
        code = table_of(list(zip(own, calls.values(), strict=True)))
    except NumbaError as error:
        reason = " ".join(str(error).split())[:300]
        raise InputError(
            f"the law {law.kind} cannot be compiled ({reason}); write it with numbers and the module math."
        ) from None
    _LAWS[code] = law
    return code


def law_of(code: int) -> Any:
    """Law that has this code."""
    return _LAWS[int(code)]


def _law(entry: EffectSpec) -> tuple[Any, tuple[float, ...]]:
    """Law of an effect of the spec, and its parameters in the order of their declaration."""
    return entry.law, entry.ordered


class Place(NamedTuple):
    """Where a law on the plant acts: on a dof, or between it and an `other` (-1: none), which feels the
    opposite.
    """

    dof: int
    other: int = -1

    def apart(self, signal: Floats) -> Floats:
        """What a law here gets of a signal (..., n) of all dofs: that of its dof, less that of the other."""
        found = signal[..., self.dof]
        return found if self.other < 0 else np.asarray(found - signal[..., self.other])


def place_of(spec: Spec, one: EffectSpec) -> Place:
    """Where an effect on the plant acts."""
    dofs = spec.plant.dofs
    return Place(dofs.index(str(one.dof)), dofs.index(one.relative_to) if one.relative_to else -1)


def plant_laws(spec: Spec) -> list[tuple[Any, tuple[float, ...], Place]]:
    """Law, parameters and place of every effect on the plant, in the order of the spec."""
    effects = [one for one in spec.effects if one.block == "plant"]
    stuck = [one.place for one in effects if one.law.partition == "friction"]  # type: ignore[attr-defined]
    for place in stuck:
        if stuck.count(place) > 1:
            raise InputError(
                f"effects: {place} has {stuck.count(place)} dry frictions, allowed "
                f"is one per dof; join them into one."
            )
    return [(*_law(one), place_of(spec, one)) for one in effects]


def _wire_effects(spec: Spec, actuator: str, pretension: float) -> list[tuple[Any, tuple[float, ...]]]:
    """Wire laws of one actuator, sorted; a pretension that is not zero makes the wire one that can go
    slack.
    """
    found = [_law(e) for e in spec.effects if e.block == "wire" and e.actuator == actuator]
    if pretension > 0.0 and not any(law.changes == "pretension" for law, _ in found):
        found.append((changing("wire", "pretension"), (pretension,)))
    return sorted(found, key=lambda pair: pair[0].order)


def wire_table(spec: Spec, at: int, m: int) -> tuple[WireTable, int]:
    """Wires of the first `m` actuators; states from `at` on are given to pulleys and laws, and the next free
    one is returned.
    """
    numbers, stiffness = np.zeros((m, 3), dtype=np.int64), np.zeros((m, 2))
    rows: list[tuple[Any, tuple[float, ...], int, int]] = []
    for a in range(m):
        assert spec.actuator is not None and spec.interface is not None
        t = spec.actuator.transmission
        moving = t is not None and t.moves
        stiffness[a] = (t.wire if t is not None and moving else spec.k_tot[a]), spec.k_tot[a]
        laws = _wire_effects(spec, spec.actuator.names[a], spec.actuator.pretension[a])
        nonlinear = any(not law.linear for law, _ in laws)
        numbers[a] = spec.plant.dofs.index(spec.interface.plant_dof[a]), at if moving else -1, nonlinear
        at += (2 if t is not None and t.inertia > 0.0 else 1) if moving else 0
        for law, p in laws if nonlinear else []:
            rows.append((law, p, a, at))
            at += law.states
    empty, paths = np.empty((0, 0)), np.array([law.path for law, *_ in rows], dtype=float).reshape(-1, 2)
    slackens = np.array([[law.changes == "pretension"] for law, *_ in rows], dtype=np.int64)
    placed, parameters = _rows(rows)
    placed = np.hstack([placed, slackens.reshape(-1, 1)])
    return WireTable(numbers, stiffness, empty, empty, placed, parameters, paths), at


def wire_laws(spec: Spec, at: int, m: int) -> tuple[list[tuple[Any, tuple[float, ...], int, int]], int]:
    """Law, parameters, actuator and first own state of every law on a linear wire."""
    found = []
    for a, name in enumerate(spec.actuator.names[:m] if spec.actuator else ()):
        assert spec.actuator is not None
        laws = _wire_effects(spec, name, spec.actuator.pretension[a])
        if all(law.linear for law, _ in laws):
            for law, p in laws:
                found.append((law, p, a, at))
                at += law.states
    return found, at


def nonlinear_wires(table: WireTable) -> list[tuple[Any, tuple[float, ...], int, int]]:
    """Law, parameters, actuator and first own state of every law on a wire that is not linear."""
    return [
        (law_of(code), tuple(p[: len(law_of(code).parameters)]), int(actuator), int(state))
        for (code, actuator, state, *_), p in zip(table.laws, table.parameters, strict=True)
    ]


def _rows(entries: list[tuple[Any, tuple[float, ...], int, int]]) -> tuple[Integers, Floats]:
    """Numbers (code, place, first state, states) and parameters of some laws, as arrays."""
    parameters = np.zeros((len(entries), MOST_PARAMETERS))
    for row, (_, p, _, _) in enumerate(entries):
        parameters[row, : len(p)] = p
    numbers = [(code_of(law), place, at, law.states) for law, _, place, at in entries]
    return np.array(numbers, dtype=np.int64).reshape(-1, 4), parameters


def reads_load(law: Any) -> bool:
    """Whether a law depends on the known load on its dof."""
    return "load" in law.depends_on


NO_MASS: Floats = np.empty((0, 0))
"""Of a plant without laws that have mass, as a table needs it."""


def law_table(
    nonlinear: list[tuple[Any, tuple[float, ...], Place, int]],
    known: Sequence[int] = (),
    mass: Floats = NO_MASS,
) -> LawTable:
    """Table of the nonlinear laws: (law, parameters, place, first own state), of a plant with a `mass`
    (n, n); `known` are the dofs of the first loads, which are known.
    """
    numbers, parameters = _rows([(law, p, place.dof, z) for law, p, place, z in nonlinear])
    at = {dof: load for load, dof in enumerate(known)}
    loaded = np.array(
        [at.get(place.dof, -1) if reads_load(law) else -1 for law, _, place, _ in nonlinear], dtype=np.int64
    )
    partitions = np.array([PARTITIONS.index(law.partition) for law, *_ in nonlinear], dtype=np.int64)
    others = np.array([place.other for _, _, place, _ in nonlinear], dtype=np.int64)
    thresholds = np.full((len(nonlinear), 2), np.inf)
    for row, (law, p, _, _) in enumerate(nonlinear):
        limits = law.thresholds(p)
        thresholds[row, : len(limits)] = limits
    return LawTable(
        np.hstack([numbers, partitions.reshape(-1, 1), loaded.reshape(-1, 1), others.reshape(-1, 1)]),
        parameters,
        thresholds,
        np.array([law.breakaway(p) for law, p, _, _ in nonlinear], dtype=float),
        _masses([law for law, *_ in nonlinear], mass),
    )


def _masses(laws: list[Any], mass: Floats) -> Masses | None:
    """What of some laws has mass, beside that of the plant (n, n)."""
    rows = [row for row, law in enumerate(laws) if has_inertia(law)]
    coupled = [row for row, law in enumerate(laws) if has_coupling(law)]
    if not (rows or coupled):
        return None
    return Masses(
        np.array(rows, dtype=np.int64),
        np.array(coupled, dtype=np.int64) if coupled else None,
        np.array(mass, dtype=float),
        np.zeros_like(mass, dtype=float),
    )
