"""Motion of a simulated test: of a file that `rthm simulate` wrote, or of a spec."""

from __future__ import annotations

import zipfile
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.comparison.motion import Motion, Signal, signal
from rthm_core.clock import NS
from rthm_core.energy import with_error
from rthm_core.errors import InputError
from rthm_core.substructure import interface

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec

COLUMNS = ("plant_position", "numerical_position", "force_reference", "actuator_force")


class Names(NamedTuple):
    """Names of dofs and actuators, and which dofs of the plant are at the interface."""

    plant: tuple[str, ...]
    numerical: tuple[str, ...]
    actuators: tuple[str, ...]
    at_interface: tuple[int, ...]

    @classmethod
    def in_order(cls, columns: dict[str, Floats]) -> Names:
        """Names where no source has a spec: ``x1`` and on, those of the plant first; ``a1`` and on."""
        n1, n2, m = (columns[name].shape[1] if name in columns else 0 for name in COLUMNS[:3])
        dofs = tuple(f"x{k}" for k in range(1, n1 + n2 + 1))
        return cls(dofs[:n1], dofs[n1:], tuple(f"a{k}" for k in range(1, m + 1)), tuple(range(n1)))


def names_of(spec: Spec) -> Names:
    """Names in a spec."""
    assert spec.plant is not None
    numerical = spec.numerical.dofs if spec.numerical else ()
    if not spec.is_loop:
        return Names(spec.plant.dofs, numerical, (), tuple(range(len(spec.plant.dofs))))
    at = tuple(int(dof) for dof in interface(spec).plant)
    return Names(spec.plant.dofs, numerical, spec.loop().actuator.names, at)


def read_trajectory(path: Path) -> dict[str, Floats]:
    """Arrays of a trajectory, by the keys of the contract, section 5.

    Raises
    ------
    InputError
        It is no trajectory, or damaged.
    """
    way_out = "write it again with rthm simulate"
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            columns = {name: np.asarray(file[name]) for name in file.files if not name.startswith("d_")}
    except (OSError, ValueError, EOFError, AttributeError, zipfile.BadZipFile, zlib.error) as reason:
        why = "it holds no plain arrays" if "pickle" in str(reason) else reason
        raise InputError(f"{path} is not an npz file that can be read ({why}); {way_out}.") from None
    missing = [name for name in ("t", "plant_position") if name not in columns]
    if missing:
        raise InputError(f"{path} has no array {missing[0]}, which every trajectory has; {way_out}.")
    rows, t = len(columns["plant_position"]), columns["t"]
    if t.dtype.kind not in "fi" or t.shape != (rows,) or rows < 2 or not (np.diff(t) > 0.0).all():
        raise InputError(
            f"t of {path} has the shape {t.shape}, but must be {max(rows, 2)} ascending times in s, one for"
            f" each row of plant_position; {way_out}."
        )
    return {name: _as_columns(path, name, values, rows) for name, values in columns.items()}


def _as_columns(path: Path, name: str, values: np.ndarray, rows: int) -> Floats:
    width = 1 if name == "t" or name.startswith("E_") else 2
    if values.dtype.kind not in "fi" or values.ndim != width or len(values) != rows:
        raise InputError(
            f"{name} of {path} is an array {values.shape} of {values.dtype}, but must be {rows} rows of"
            " numbers; write it again with rthm simulate."
        )
    return values.astype(float, copy=False)


def motion_of_spec(name: str, spec: Spec, duration: float) -> Motion:
    """Motion of a spec, simulated exactly for so many seconds."""
    from rthm_core.engine import simulate

    found = simulate(spec, duration)
    columns = {key: values for key, values in vars(found).items() if key != "energies"} | found.energies
    columns |= _motors(spec, columns)
    return motion_of_columns(name, "simulation", columns, names_of(spec), spec)


def _motors(spec: Spec, columns: dict[str, Floats]) -> dict[str, Floats]:
    """Positions of the motors, from the force in their wires: F = k_tot (u - x1) where nothing else is."""
    if not spec.is_loop or any(effect.block == "wire" for effect in spec.effects):
        return {}
    at = columns["plant_position"][:, interface(spec).plant]
    return {"motor_position": at + columns["actuator_force"] / np.array(spec.k_tot)}


def motion_of_columns(
    name: str, kind: str, columns: dict[str, Floats], names: Names, spec: Spec | None = None
) -> Motion:
    """Motion from the arrays of a trajectory.

    Raises
    ------
    InputError
        It has other numbers of dofs or actuators than there are names.
    """
    at_ns = np.rint(columns["t"] * NS).astype(np.int64)
    signals: dict[str, Signal] = {}
    for key, unit, wanted in (
        ("plant_position", "m", names.plant),
        ("numerical_position", "m", names.numerical),
        ("motor_position", "m", tuple(f"{one}.motor" for one in names.actuators)),
        ("force_reference", "N", tuple(f"{one}.reference" for one in names.actuators)),
        ("actuator_force", "N", tuple(f"{one}.force" for one in names.actuators)),
    ):
        values = columns.get(key, np.empty((at_ns.size, 0)))
        if values.shape[1] not in (0, len(wanted)):
            raise InputError(
                f"{key} of {name} has {values.shape[1]} columns, but the other tests have {len(wanted)}"
                f" ({', '.join(wanted) or 'none'}); compare tests of the same rig."
            )
        for one, column in zip(wanted, values.T, strict=False):
            signals |= signal(one, unit, at_ns, column)
    energies = {key: values for key, values in columns.items() if key.startswith("E_")}
    for term, values in with_error(energies).items():
        signals |= signal(term, "J", at_ns, values)
    dofs = tuple(dof for dof in (*names.plant, *names.numerical) if dof in signals)
    if not dofs:
        raise InputError(f"{name} has no known position; compare tests in which something moves.")
    passed = _passed(at_ns, columns, names)
    return Motion(name, kind, signals, dofs, names.actuators, spec, passed=passed)


def _passed(at_ns: Integers, columns: dict[str, Floats], names: Names) -> Signal | None:
    """Integral of the squared velocity of the plant at the interface, m^2/s."""
    velocity = columns.get("plant_velocity")
    if velocity is None or velocity.shape[1] <= max(names.at_interface):
        return None
    with np.errstate(over="ignore", invalid="ignore"):  # of an unstable loop
        squared = np.square(velocity[:, list(names.at_interface)]).sum(axis=1)
        steps = 0.5 * (squared[1:] + squared[:-1]) * np.diff(columns["t"])
    return signal("passed", "m^2/s", at_ns, np.append(0.0, np.cumsum(steps))).get("passed")
