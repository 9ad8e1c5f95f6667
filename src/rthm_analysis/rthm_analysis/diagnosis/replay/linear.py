"""What forces do to a linear plant with linear wires: exact steps from sample to sample, many forces at once.

A replay takes a step for each force by itself, whatever laws there are. Without any, all forces share a few
step matrices, and a step costs a few products each.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.replay.compiled import compiled
from rthm_analysis.diagnosis.replay.experiment import effects_on
from rthm_analysis.diagnosis.replay.mechanics import Mechanics, mechanics, wire_forces
from rthm_analysis.diagnosis.replay.sensing import levelled
from rthm_core.exponential import exponentials
from rthm_core.physical.laws import NONLINEAR, Place

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
    from rthm_core.compiled import Flags, Floats, Integers
    from rthm_core.spec import Spec


class LinearResponse(NamedTuple):
    """A linear plant between the samples (s) of a recording, seen at some of them (u).

    Attributes
    ----------
    steps : (d, ny, ny + 2 n) array
        State at the end of an interval of each length, from the state and the forces on the dofs at its
        start, and the forces at its end.
    which : (s,) array
        Length of the interval before each sample.
    begins : (s,) array
        Whether a free run begins there.
    row : (s,) array
        Place of each sample among those that are seen; -1: it is not.
    sensors : (k, ny + n) array
        What the channels see of the state and of the forces.
    seen : Evidence
        The samples that are seen.
    """

    steps: Floats
    which: Integers
    begins: Flags
    row: Integers
    sensors: Floats
    seen: Evidence

    def to(self, forces: Floats, place: Place) -> Floats:
        """Change (p, u, k) of what the channels read with forces (s, p) at a place, straight between the
        samples.
        """
        size, n, count = self.steps.shape[1], self.sensors.shape[1] - self.steps.shape[1], forces.shape[1]
        by_state, *by_forces = np.split(self.steps, [size, size + n], axis=2)
        steps = np.concatenate([by_state, *(place.apart(one)[..., None] for one in by_forces)], axis=2)
        of_state, of_force = np.split(self.sensors, [size], axis=1)
        sensors = np.concatenate([of_state, place.apart(of_force)[:, None]], axis=1)
        out = np.empty((self.seen.time.size, len(sensors), count))
        state = np.empty((2, size, count))
        _respond(steps, self.which, self.begins, self.row, sensors, np.ascontiguousarray(forces), state, out)
        found = np.ascontiguousarray(out.transpose(2, 0, 1))
        self._level(found)
        return found

    def _level(self, found: Floats) -> None:
        """Take out the offset that leaves least of what has one of its own in each recording."""
        for k, channel in enumerate(self.seen.channels):
            if channel.family == "acceleration" or channel in self.seen.own_zero:
                nothing = 0.0 * self.seen.measured[:, k]
                for one in found[:, :, k]:
                    one[:] = levelled(one, nothing, self.seen.recordings, one.size)


def linear_response(
    spec: Spec, evidence: Evidence, seen: Evidence, starts: Integers
) -> LinearResponse | None:
    """The plant of a spec between all samples of a recording, seen at some of them; None where it is not
    linear, or a sensor is off.

    Parameters
    ----------
    spec : Spec
    evidence, seen : Evidence
        All samples, and those that are seen, which are some of these.
    starts : (r,) array
        Seen samples at which free runs begin, at which nothing has happened yet.
    """
    arrays = mechanics(spec)
    bends = arrays.laws.numbers.shape[0] > 0 or bool(arrays.wires.numbers[:, NONLINEAR].any())
    known = all(one.family in _FAMILIES and not effects_on(spec, one) for one in seen.channels)
    if bends or not known:
        return None
    assert spec.plant is not None
    lengths, which = np.unique(
        np.diff(evidence.stamps_ns, prepend=evidence.stamps_ns[0]), return_inverse=True
    )
    row = np.full(evidence.stamps_ns.size, -1)
    at = np.searchsorted(evidence.stamps_ns, seen.stamps_ns)
    row[at] = np.arange(at.size)
    begins = np.zeros(row.size, dtype=bool)
    begins[at[starts]] = True
    names = spec.plant.dofs, spec.actuator.names if spec.actuator else ()
    sensors = np.stack([_sensor(arrays, one, *names) for one in seen.channels])
    return LinearResponse(_steps(arrays, lengths), which.ravel(), begins, row, sensors, seen)


_FAMILIES = ("position", "velocity", "acceleration", "force")


def _steps(arrays: Mechanics, lengths_ns: Integers) -> Floats:
    """Step matrices (d, ny, ny + 2 n) under forces that go straight from their first to their last value."""
    size, n = arrays.initial.size, arrays.n
    whole = np.zeros((size + 2 * n, size + 2 * n))  # state, forces, and by how much these grow
    whole[:size, :size], whole[:size, size : size + n] = arrays.a, arrays.by_loads
    whole[size : size + n, size + n :] = np.eye(n)
    found = exponentials(whole, lengths_ns)[:, :size]
    last = found[:, :, size + n :] / np.maximum(lengths_ns * 1e-9, 1e-300)[:, None, None]
    return np.concatenate([found[:, :, :size], found[:, :, size : size + n] - last, last], axis=2)


def _sensor(arrays: Mechanics, channel: Channel, dofs: tuple[str, ...], wires: tuple[str, ...]) -> Floats:
    """What a channel sees of the state and of the forces on the dofs: (ny + n,)."""
    size, n = arrays.initial.size, arrays.n
    row = np.zeros(size + n)
    if channel.family == "force":
        row[:size] = wire_forces(arrays)[wires.index(channel.place)]
        return row
    dof = dofs.index(channel.place)
    if channel.family == "acceleration":
        row[:size], row[size:] = arrays.a[n + dof], arrays.by_loads[n + dof]
    else:
        row[dof if channel.family == "position" else n + dof] = 1.0
    return row


@compiled
def _respond(
    steps: Floats,
    which: Integers,
    begins: Flags,
    row: Integers,
    sensors: Floats,
    forces: Floats,
    state: Floats,
    out: Floats,
) -> None:
    """Run through all samples, the forces side by side; `out` (u, k, p) gets what the channels read."""
    size, count = steps.shape[1], forces.shape[1]
    y, end = state[0], state[1]
    for i in range(size):
        for p in range(count):
            y[i, p] = 0.0
    for s in range(which.size):
        if begins[s]:
            for i in range(size):
                for p in range(count):
                    y[i, p] = 0.0
        elif s > 0:
            step = steps[which[s]]
            for i in range(size):
                first, last = step[i, size], step[i, size + 1]
                for p in range(count):
                    end[i, p] = first * forces[s - 1, p] + last * forces[s, p]
                for j in range(size):
                    factor = step[i, j]
                    for p in range(count):
                        end[i, p] += factor * y[j, p]
            for i in range(size):
                for p in range(count):
                    y[i, p] = end[i, p]
        if row[s] >= 0:
            for k in range(sensors.shape[0]):
                direct = sensors[k, size]
                for p in range(count):
                    out[row[s], k, p] = direct * forces[s, p]
                for i in range(size):
                    factor = sensors[k, i]
                    if factor != 0.0:
                        for p in range(count):
                            out[row[s], k, p] += factor * y[i, p]
