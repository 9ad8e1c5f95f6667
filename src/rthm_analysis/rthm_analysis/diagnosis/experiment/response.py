"""Linear response of a closed loop: how large a load may be at each frequency, and where the modes are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.experiment import (
    HIGHEST_MODE_RATIO,
    SWINGING_DAMPING_RATIO,
    UNSTABLE_GROWTH,
)
from rthm_analysis.diagnosis.experiment.closed import closed_loop, loaded
from rthm_analysis.diagnosis.replay.mechanics import state_matrix, wire_forces
from rthm_core.physical.laws import DOF

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


class Response:
    """Small motion of a test under a load.

    Parameters
    ----------
    spec : Spec
        Loop, or plant alone.
    """

    def __init__(self, spec: Spec) -> None:
        self.spec, self.closed = spec, closed_loop(spec)
        self.a = state_matrix(self.closed)
        self._rates = np.linalg.eigvals(self.a)

    @property
    def modes(self) -> Floats:
        """Frequencies, rad/s, of the slowest modes that swing, ascending; empty where none does."""
        swinging = (self._rates.imag > 0.0) & (
            -self._rates.real < SWINGING_DAMPING_RATIO * np.abs(self._rates)
        )
        rates = np.sort(np.abs(self._rates[swinging]))
        return np.asarray(rates[rates <= HIGHEST_MODE_RATIO * rates[0]] if rates.size else rates)

    @property
    def unstable(self) -> bool:
        """Whether the motion grows by itself."""
        return bool(np.any(self._rates.real > UNSTABLE_GROWTH * np.abs(self._rates).max()))

    def sizes(self, side: str, dof: str, frequency: float) -> dict[str, float]:
        """Amplitude of a steady swing under a load of 1 N, by family of signals.

        Parameters
        ----------
        side : str
            ``plant`` or ``numerical``.
        dof : str
            Where the load acts.
        frequency : float
            rad/s; 0: a constant load.
        """
        assert self.spec.plant is not None
        n, wires = self.closed.n, self.closed.wires
        if side == "numerical":
            input_vector = loaded(self.closed, self.spec, dof).by_motors[:, 0]
        else:
            input_vector = self.closed.by_loads[:, self.spec.plant.dofs.index(dof)]
        swing = 1j * frequency * np.eye(input_vector.size) - self.a
        state = np.linalg.lstsq(swing, input_vector.astype(complex), rcond=None)[0]
        force = wire_forces(self.closed) @ state
        command = state[wires.numbers[:, DOF]] + force / wires.stiffness[:, 0]
        rate = frequency * np.abs(command)
        found = {"position": state[:n], "velocity": state[n : 2 * n], "force": force, "command": command}
        return {name: float(np.abs(one).max(initial=0.0)) for name, one in (found | {"rate": rate}).items()}
