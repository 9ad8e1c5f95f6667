"""Errors that the hybrid loop brings in: (14a), (14b), (14c), (22a), (26f) and (27).

What is printed with a wrong sign shows in the energy balance: with it, the balance does not close.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from rthm_analysis.energy.model import estimated_power
from rthm_analysis.reproduce.candidates import loop
from rthm_analysis.reproduce.errata.erratum import Erratum
from rthm_core.engine import Trajectory, simulate
from rthm_core.engine.coupled.body import coupled_body
from rthm_core.physical.side import PhysicalSide

DURATION, STEP = 20.0, 0.0012


@cache
def _test() -> Trajectory:
    return simulate(loop(), DURATION, STEP)


def _balance_with(term: str, sign: float) -> float:
    """Largest balance error with the work of one term counted with another sign, J."""
    run = _test()
    return float(np.abs(run.balance_error + (1.0 - sign) * run.energies[term]).max())


def error_on_the_numerical_side() -> Erratum:
    """(14a), by the balance of energy."""
    return Erratum(
        "(14a)",
        "F_c(delayed) - F_c",
        "F_c - F_c(delayed), as mass 2 feels -F_c",
        "balance of energy over the step test, J",
        _balance_with("E_num", -1.0),
        _balance_with("E_num", 1.0),
    )


def error_on_the_physical_side() -> Erratum:
    """(14b) and (22a), by the balance of energy."""
    return Erratum(
        "(14b), (22a)",
        "F_fx + F_c - F_ff + eps",
        "F_fx + F_ff - F_c + eps",
        "balance of energy over the step test, J",
        _balance_with("E_ff", -1.0),
        _balance_with("E_ff", 1.0),
    )


def stiffness_in_the_cancellation() -> Erratum:
    """(14c): the force in the wire before the test."""
    spec = loop()
    sides = spec.loop()
    x1, k_tot = sides.plant.initial_position[0], spec.k_tot[0]
    force = -sides.interface.stiffness[0] * x1
    u = x1 + force / k_tot
    measured = PhysicalSide(spec).sample(0).force[0]
    return Erratum(
        "(14c)",
        "numbered twice; kappa_tot",
        "k_tot",
        "k_tot (u - x1) against the simulated wire before the test, N",
        None,
        abs(k_tot * (u - x1) - measured),
    )


def place_of_epsilon() -> Erratum:
    """(26f): where a constant error of the wire's force moves the masses to, in the end."""
    force = 0.1
    rest: dict[str, Any]
    rest = {"plant.initial_position": 0.0, "load.plant": {"dof": "x1", "kind": "constant", "force": force}}
    run = simulate(loop(**rest), 120.0, 120.0, energies=False)
    moved = np.array([run.plant_position[-1, 0], run.numerical_position[-1, 0]])
    compliance = np.linalg.inv(coupled_body(loop(), "ideal").stiffness)
    printed, corrected = compliance @ [0.0, force], compliance @ [force, 0.0]
    size = np.abs(moved).max()
    return Erratum(
        "(26f)",
        "[0, eps]",
        "[eps, 0]",
        "rest position under a constant force on mass 1 against K^-1 of (26c) times the vector, relative",
        float(np.abs(printed - moved).max() / size),
        float(np.abs(corrected - moved).max() / size),
    )


def power_of_the_errors() -> Erratum:
    """(27), integrated over the step test."""
    run = _test()
    velocity = np.hstack([run.plant_velocity, run.numerical_velocity])
    acceleration = np.gradient(velocity, run.t, axis=0)
    estimate = float(np.trapezoid(estimated_power(loop(), velocity, acceleration), run.t))
    exact = float(sum(run.energies[term][-1] for term in ("E_num", "E_ff", "E_fx")))
    return Erratum(
        "(27)",
        "adds the two quadratic terms",
        "subtracts them",
        "integral over the step test against the exact E_err, relative",
        abs(-estimate / exact - 1.0),
        abs(estimate / exact - 1.0),
    )


CHECKS = (
    error_on_the_numerical_side,
    error_on_the_physical_side,
    stiffness_in_the_cancellation,
    place_of_epsilon,
    power_of_the_errors,
)
