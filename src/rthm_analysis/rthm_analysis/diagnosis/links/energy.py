"""What an older sample costs in energy: power of the change of force on the moving masses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.recording import Recording, Table
from rthm_core.clock import NS
from rthm_core.substructure import interface
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def extra_energy(recording: Recording, spec: Spec, name: str, extra: float) -> float:
    """Work, J, that an extra delay of mean `extra` (s) of a link does over the recording; + introduced.

    To first order the delayed signal is short of ``extra`` times its rate. For tau1 the force on the plant
    then changes by ``-k_tot extra v1``, for tau4 by ``-k_tot extra du_d/dt``, for tau3 by
    ``-extra dF_d/dt``, and for tau2 by ``+k2 extra v1`` on the plant and ``-k2 extra v1`` on the numerical
    substructure. NaN: a signal is not recorded.
    """
    plant, loop, sides = recording.plant, spec.loop(), interface(spec)
    v1 = plant.columns("velocity", loop.interface.plant_dof)
    if name == "tau1":
        return _work(plant, -extra * np.array(spec.k_tot) * v1, v1)
    if name == "tau2":
        v2 = _held(recording, NUMERICAL_STATE, "velocity", loop.interface.numerical_dof)
        return _work(plant, extra * sides.stiffness * v1, v1 - v2)
    if name == "tau3":
        rate = _rate(recording, FORCE_REFERENCE, "effort", loop.actuator.names)
        return _work(plant, -extra * rate, v1)
    rate = _rate(recording, COMMAND, "position", loop.actuator.names)
    return _work(plant, -extra * np.array(spec.k_tot) * rate, v1)


def _work(plant: Table, force: Floats, velocity: Floats) -> float:
    """Integral of force times velocity (n, m) over the samples of the plant, J."""
    power = np.nansum(force * velocity, axis=1)
    known = np.isfinite(force * velocity).any()
    return float(np.sum(power[:-1] * np.diff(plant.stamp_ns)) / NS) if known else float("nan")


def _held(recording: Recording, topic: str, field: str, names: tuple[str, ...] | list[str]) -> Floats:
    """Signal (n, m) at the samples of the plant; NaN where it is not recorded."""
    at = recording.plant.stamp_ns
    table = recording.tables.get(topic)
    if table is None:
        return np.full((at.size, len(names)), np.nan)
    times, values = table.stamp_ns - recording.start_ns, table.columns(field, names)
    return np.column_stack([np.interp(at - recording.start_ns, times, column) for column in values.T])


def _rate(recording: Recording, topic: str, field: str, names: tuple[str, ...] | list[str]) -> Floats:
    """Rate of change (n, m) at the samples of the plant."""
    time = recording.plant.stamp_ns * 1e-9
    return np.gradient(_held(recording, topic, field, names), time - time[0], axis=0)
