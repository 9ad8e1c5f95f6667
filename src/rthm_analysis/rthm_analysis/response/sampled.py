"""Exact response of the sampled loop: what its motion contains of the load's frequency.

Under a load e^{iwt} the lifted state settles where ``s(T) = e^{iwT} s(0)``. Between the events, the motion is
that of the two sides alone under the load, plus what the staircases of commands and held motion add; see
`rthm_analysis.lifted.harmonics`.
"""

from __future__ import annotations

import numpy as np

from rthm_analysis.lifted.harmonics import Complex, components
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.walk import Forcing
from rthm_core.compiled import Floats
from rthm_core.errors import InputError
from rthm_core.schedule import REFERENCE, SAMPLE


def sampled(lifted: Lifted, omega: Floats) -> Complex:
    """Fundamental components (W, N, N), m/N, from loads on all dofs to positions of all dofs.

    Raises
    ------
    InputError
        When the loop itself oscillates at the load's frequency without fading.
    """
    monodromy = lifted.monodromy()
    return np.stack([_at(lifted, monodromy, float(w)) for w in omega])


def _at(lifted: Lifted, monodromy: Floats, w: float) -> Complex:
    loop, n1 = lifted.loop, lifted.loop.position1.shape[0]
    alone1 = np.linalg.solve(1j * w * np.eye(loop.a1.shape[0]) - loop.a1, loop.l1.astype(complex))
    alone2 = np.linalg.solve(1j * w * np.eye(loop.a2.shape[0]) - loop.a2, loop.l2.astype(complex))
    forcing = _forcing(lifted, loop.sampled @ alone1, loop.force_state @ alone2, w)
    count = alone1.shape[1] + alone2.shape[1]
    gained = lifted.advanced(np.zeros((lifted.size, count), dtype=complex), forcing)
    turn = np.exp(1j * w * lifted.cycle.hyperperiod)
    try:
        settled = np.linalg.solve(turn * np.eye(lifted.size) - monodromy, gained)
    except np.linalg.LinAlgError:
        raise InputError(
            f"The frequency response at omega {w!r} rad/s is infinite: it is a natural frequency of an "
            "undamped mode of the loop; choose another frequency."
        ) from None
    found = components(lifted, settled, np.array([1j * w]), forcing)[:, :, 0]
    found[:n1, :n1] += loop.position1 @ alone1
    found[n1:, n1:] += loop.position2 @ alone2
    return found


def _forcing(lifted: Lifted, sample: Complex, force: Complex, w: float) -> Forcing:
    """What unit loads on the dofs of both sides add to every sample and every reference."""
    cycle, m = lifted.cycle, lifted.loop.actuators
    n1, count = sample.shape[1], sample.shape[1] + force.shape[1]
    wave = np.exp(1j * w * cycle.time * cycle.unit)[:, None, None]
    samples = np.zeros((cycle.time.size, 2 * m, count), dtype=complex)
    samples[:, :, :n1] = np.where((cycle.what == SAMPLE)[:, None, None], wave, 0.0) * sample
    references = np.zeros((cycle.time.size, m, count), dtype=complex)
    references[:, :, n1:] = np.where((cycle.what == REFERENCE)[:, None, None], wave, 0.0) * force
    return Forcing(samples, references, samples[:0])
