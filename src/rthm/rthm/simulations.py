"""Simulate tests: one, one with its derivatives, many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy.typing as npt

from rthm.motions import Derivatives, Ensemble, Simulation
from rthm.specs import Named, load
from rthm_core import engine


def simulate(
    spec: Named,
    duration: float,
    *,
    sample: float | None = None,
    system: str = "hybrid",
    energies: bool = True,
) -> Simulation:
    """Simulate a test exactly.

    Parameters
    ----------
    spec : str, Path or Spec
        Name of a shipped spec, path, or spec; a loop, or a plant alone.
    duration : float
        Length in s.
    sample : float, optional
        Distance of the rows in s; Td1 (or 1 ms for a plant alone) when absent.
    system : {"hybrid", "ideal", "taylor"}
        The loop with its delays; the same without delays, holds and actuator; or the first-order
        approximation (25) and (26) of the paper.
    energies : bool
        Whether work is counted.

    Returns
    -------
    Simulation

    Raises
    ------
    InputError
        If there is no such spec, duration or sample is not a positive number, or `system` is unknown.

    Examples
    --------
    >>> import rthm
    >>> run = rthm.simulate("paper", 20)
    >>> begin, end = run.energies["E_total"][[0, -1]]
    >>> f"{end:.5f} J of {begin:.2f} J are left"
    '0.00466 J of 2.25 J are left'
    >>> picture = run.plot("x1.position", "x2.position")
    """
    test = load(spec)
    found = engine.simulate(test, duration, sample, system, energies=energies)
    found.energies = found.all_energies()
    return Simulation.of(found, spec=test)


def sensitivities(
    spec: Named, duration: float, names: Sequence[str] | None = None, *, sample: float | None = None
) -> Derivatives:
    """Simulate a loop exactly, and how its motion changes with numbers of its spec.

    Parameters
    ----------
    spec : str, Path or Spec
        Name of a shipped spec, path, or spec, of a loop.
    duration : float
        Length in s.
    names : sequence of str, optional
        Numbers of the spec, as ``plant.mass``; every one of the physics when absent.
    sample : float, optional
        Distance of the rows in s; Td1 when absent.

    Returns
    -------
    Derivatives

    Raises
    ------
    InputError
        If the spec is no loop, or a name is not that of a number on which the motion depends smoothly.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.sensitivities("paper", 1.0, ["plant.mass"])
    >>> f"{found.by_parameter['plant.mass'].plant_position[-1, 0]:.3f} m/kg"
    '-0.411 m/kg'
    """
    test = load(spec)
    return Derivatives.of(engine.sensitivities(test, duration, names, sample), spec=test)


def simulate_many(
    spec: Named, changes: Mapping[str, npt.ArrayLike], duration: float, *, sample: float | None = None
) -> Ensemble:
    """Simulate many loops that differ in some numbers.

    Parameters
    ----------
    spec : str, Path or Spec
        Name of a shipped spec, path, or spec: what all loops have in common.
    changes : mapping of str to array
        Entries of the spec, as ``plant.mass``; the first axis of each is the loop.
    duration : float
        Length in s.
    sample : float, optional
        Distance of the rows in s; Td1 when absent.

    Returns
    -------
    Ensemble

    Raises
    ------
    InputError
        If the entries have different numbers of loops, or one of the loops is not allowed.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.simulate_many("paper", {"plant.mass": [1.1, 1.2, 1.3]}, 1.0, sample=0.1)
    >>> found.plant_position.shape
    (3, 11, 1)
    """
    test = load(spec)
    return Ensemble.of(engine.simulate_many(test, changes, duration, sample), spec=test)
