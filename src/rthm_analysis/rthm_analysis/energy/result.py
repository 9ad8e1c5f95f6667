"""Energy balance of a whole recording."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.energy.ledger import EnergyLedger, Rows
from rthm_analysis.energy.model import plant_alone
from rthm_analysis.recording import Recording, Table
from rthm_analysis.recording.synchronised import synchronised
from rthm_core.clock import NS
from rthm_core.compiled import Floats
from rthm_core.energy import OF_THE_LOOP, TERMS
from rthm_core.errors import InputError
from rthm_core.spec import Spec
from rthm_core.substructure import interface
from rthm_core.topics import COMMAND, NUMERICAL_STATE

POINTS = 5000
"""Rows in the JSON of a long recording."""

NEEDED = (NUMERICAL_STATE, COMMAND)
"""Topics without which only the plant's own energy can be computed."""


@dataclass(frozen=True)
class EnergyResult:
    """Energies of a recorded test at the samples of the plant; work is + when introduced.

    Attributes
    ----------
    t : (n,) array
        s since the start of the test.
    work : dict of (n,) arrays
        ``E_num``, ``E_ff``, ``E_fx``, ``E_damping``, ``E_load``, ``E_effects``, J; NaN: cannot be told.
    total : (n,) array
        E_total, J.
    estimate : (n,) array
        P_err_estimate: power of the corrected (27), W.
    passed : (n,) array
        Integral of the squared velocity of the plant at the interface, m^2/s.
    notes : tuple of str
        What could not be computed, and why.
    """

    t: Floats
    work: dict[str, Floats]
    total: Floats
    estimate: Floats
    passed: Floats
    notes: tuple[str, ...]

    @property
    def error(self) -> Floats:
        """E_err: what delays, holds and actuator brought in, J."""
        return np.asarray(sum(self.work[term] for term in OF_THE_LOOP))

    @property
    def balance_error(self) -> Floats:
        """E_total - E_total(0) - sum of all work, J: the check."""
        known = [work for work in self.work.values() if not np.isnan(work).all()]
        return np.asarray(self.total - self.total[0] - sum(known))

    @property
    def estimated_error(self) -> Floats:
        """Integral of P_err_estimate, J: what E_err is to first order in the delays."""
        mean = 0.5 * (self.estimate[1:] + self.estimate[:-1])
        return np.append(0.0, np.cumsum(mean * np.diff(self.t)))

    @property
    def equivalent_damping(self) -> float:
        """Damper between plant and ground that would have drained as much as E_err did, N s/m."""
        return float(-self.error[-1] / self.passed[-1]) if self.passed[-1] > 0.0 else float("nan")

    def as_dict(self, points: int = POINTS) -> dict[str, object]:
        """Contract, section 5: keys of ``rthm energy --json``; about `points` rows at most, both ends too."""
        stride = max(1, -(-self.t.size // points))
        rows = np.unique(np.append(np.arange(0, self.t.size, stride), self.t.size - 1))
        columns = {"t": self.t} | {name: self.work[name] for name in OF_THE_LOOP} | {"E_err": self.error}
        columns |= {name: work for name, work in self.work.items() if name not in OF_THE_LOOP}
        columns |= {
            "P_err_estimate": self.estimate,
            "E_total": self.total,
            "balance_error": self.balance_error,
        }
        result: dict[str, object] = {name: values[rows].tolist() for name, values in columns.items()}
        return result | {"equivalent_damping": self.equivalent_damping, "notes": list(self.notes)}


def energy_of(recording: Recording, spec: Spec | None) -> EnergyResult:
    """Compute the energy balance of a recorded test.

    Parameters
    ----------
    recording : Recording
    spec : Spec, optional
        What the test was; by default the one in the recording.

    Raises
    ------
    InputError
        There is no spec, or the recording does not have the plant's dofs.
    """
    spec, recording = spec or recording.known_spec(), synchronised(recording)
    missing = [dof for dof in spec.plant.dofs if dof not in recording.plant.names]
    if missing:
        names = ", ".join(recording.plant.names)
        raise InputError(
            f"{recording.path} has the names {names}, but the spec's plant has {missing[0]}: rename one."
        )
    absent = [topic for topic in NEEDED if topic not in recording.tables]
    if spec.is_loop and not absent:
        return _balance_of_loop(recording, spec)
    return _balance_of_plant(recording, spec, absent)


def _ledger(recording: Recording, spec: Spec) -> EnergyLedger:
    stamps = recording.plant.stamp_ns
    median = float(np.median(np.diff(stamps))) / NS if stamps.size > 1 else 1.0
    return EnergyLedger(spec, recording.start_ns, spec.timing.td1 if spec.timing else median)


def _balance_of_loop(recording: Recording, spec: Spec) -> EnergyResult:
    loop, notes = spec.loop(), []
    ledger, plant, command = _ledger(recording, spec), recording.plant, recording.tables[COMMAND]
    ledger.add_plant(
        plant.stamp_ns, *_motion(plant, loop.plant.dofs), plant.columns("effort", loop.plant.dofs)
    )
    numerical = recording.tables[NUMERICAL_STATE]
    ledger.add_numerical(numerical.stamp_ns, *_motion(numerical, loop.numerical.dofs))
    names = loop.actuator.names
    ledger.add_commands(
        command.stamp_ns, command.columns("position", names), command.columns("effort", names)
    )
    for name in ("tau2", "tau4"):
        if name in recording.links:
            ledger.add_uses(name, recording.links[name].use_ns, recording.links[name].sample_ns)
        else:
            notes.append(
                f"links/{name} is not recorded: its uses were taken to be those of the exact schedule."
            )
    rows = ledger.advance()
    if not rows.stamp_ns.size:
        raise InputError(
            f"{recording.path} is too short: it needs a tick of every clock and the delays after it."
        )
    if ledger.begin_ns != recording.start_ns:
        begin = (rows.stamp_ns[0] - recording.start_ns) / NS
        notes.append(
            "the recording begins within a test: "
            f"the energy balance begins {begin:.3f} s after its first sample."
        )
    return _result(recording, spec, rows, rows.work, notes)


def _balance_of_plant(recording: Recording, spec: Spec, absent: list[str]) -> EnergyResult:
    """Energy balance of the plant alone, under all forces that were measured on it."""
    notes = []
    if spec.is_loop:
        notes.append(
            f"{' and '.join(absent)} not recorded: the energy balance is that of the plant alone, "
            "and E_load has the work of the measured actuator forces."
        )
    alone, plant = plant_alone(spec), recording.plant
    ledger = _ledger(recording, alone)
    ledger.add_plant(plant.stamp_ns, *_motion(plant, spec.plant.dofs), _forces(recording, spec))
    rows = ledger.advance()
    if not rows.stamp_ns.size:
        raise InputError(
            f"{recording.path} has no sample with a position: record the position of {spec.plant.dofs[0]}."
        )
    notes.append("E_num, E_ff, E_fx and E_err belong to a loop: they are not defined for a plant alone.")
    work = rows.work.copy()
    work[:, [TERMS.index(name) for name in OF_THE_LOOP]] = np.nan
    return _result(recording, spec, rows, work, notes)


def _motion(table: Table, dofs: tuple[str, ...]) -> tuple[Floats, Floats]:
    return table.columns("position", dofs), table.columns("velocity", dofs)


def _forces(recording: Recording, spec: Spec) -> Floats:
    """All measured forces on the dofs: known loads, and those of whatever is recorded beside the dofs."""
    plant, dofs = recording.plant, spec.plant.dofs
    loads = np.nan_to_num(plant.columns("effort", dofs))
    if spec.is_loop and spec.actuator:
        forces = np.nan_to_num(plant.columns("effort", spec.actuator.names))
        np.add.at(loads.T, interface(spec).plant, forces.T)
    elif len(dofs) == 1:
        others = [name for name in plant.names if name not in dofs]
        loads[:, 0] += np.nan_to_num(plant.columns("effort", others)).sum(axis=1)
    return loads


def _result(recording: Recording, spec: Spec, rows: Rows, work: Floats, notes: list[str]) -> EnergyResult:
    t = (rows.stamp_ns - recording.start_ns) / NS
    plant = recording.plant
    if np.isnan(plant.columns("velocity", spec.plant.dofs)).any():
        notes.append("the plant's velocity is not measured everywhere: it was estimated from the positions.")
    return EnergyResult(
        t, dict(zip(TERMS, work.T, strict=True)), rows.total, rows.estimate, rows.passed, tuple(notes)
    )
