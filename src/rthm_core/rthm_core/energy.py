"""Energy balance: the powers of the loop, and how they are integrated between two instants.

All energies are work done on the moving masses, in joule, + when it is introduced (contract, section 1;
paper, (13) and (14) with the corrected signs).

Between the ends of a smooth step, positions follow the quintic through position, velocity and acceleration at
both ends; powers are integrated by
Gauss quadrature of order 8. The same code keeps the ledger of a simulation and of a recording.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, uncompiled
from rthm_core.substructure import interface, substructure

if TYPE_CHECKING:
    from rthm_core.spec import Spec

TERMS = ("E_num", "E_ff", "E_fx", "E_damping", "E_load", "E_effects")
"""Terms of work in the order in which the ledger keeps them."""

OF_THE_LOOP = TERMS[:3]
"""Those that a loop without delays, holds and motors would not have; their sum is E_err."""

NUM, FF, FX, DAMPING, LOAD, EFFECTS = range(6)

GAUSS_NODES = np.array([0.069431844202973712, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629])
GAUSS_WEIGHTS = np.array([0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693])


def with_error(energies: dict[str, Floats]) -> dict[str, Floats]:
    """Energies with ``E_err``, the sum of the three errors of the loop, where these are known."""
    if "E_err" in energies or not energies.keys() >= set(OF_THE_LOOP):
        return dict(energies)
    with np.errstate(over="ignore", invalid="ignore"):  # of an unstable loop
        return energies | {"E_err": np.sum([energies[term] for term in OF_THE_LOOP], axis=0)}


class Bodies(NamedTuple):
    """Masses, dampers and springs of the whole loop: what energy is counted on.

    Attributes
    ----------
    m1, c1, k1, m2, c2, k2 : (n, n) arrays
        Mass, damping and stiffness of the plant and of the numerical substructure.
    plant, numerical : (m,) arrays
        Interface dofs of both sides.
    stiffness, damping : (m,) arrays
        Interface spring and damper (the paper's k2 and c2).
    k_tot : (m,) array
        Stiffness between motor and plant.
    """

    m1: Floats
    c1: Floats
    k1: Floats
    m2: Floats
    c2: Floats
    k2: Floats
    plant: Integers
    numerical: Integers
    stiffness: Floats
    damping: Floats
    k_tot: Floats


def bodies(spec: Spec) -> Bodies:
    """Bodies of a spec; those that a plant alone does not have are empty."""
    one = substructure(spec.plant)
    if not spec.is_loop:
        none, no_index = np.empty(0), np.empty(0, dtype=np.int64)
        square = np.empty((0, 0))
        return Bodies(
            one.mass, one.damping, one.stiffness, square, square, square, no_index, no_index, none, none, none
        )
    two, sides = substructure(spec.loop().numerical), interface(spec)
    return Bodies(
        one.mass,
        one.damping,
        one.stiffness,
        two.mass,
        two.damping,
        two.stiffness,
        sides.plant,
        sides.numerical,
        sides.stiffness,
        sides.damping,
        np.array(spec.k_tot, dtype=float),
    )


class Moment(NamedTuple):
    """All signals that the powers need at one instant.

    Attributes
    ----------
    x1, v1, x2, v2 : (n,) arrays
        Motion of both substructures.
    held : (2 m,) array
        [x1, v1] at the interface as the numerical side holds them.
    u_fx, u_ff : (m,) arrays
        What h(s) makes of the position-cancellation and feedforward parts of the commands, in m.
    w1, w2 : (n,) arrays
        Known external loads.
    free : (n,) array
        M1 a1 + c1 v1 + k1 x1: all that acts on the plant from outside, actuators and effects included.
    """

    x1: Floats
    v1: Floats
    x2: Floats
    v2: Floats
    held: Floats
    u_fx: Floats
    u_ff: Floats
    w1: Floats
    w2: Floats
    free: Floats


def moment(n1: int, n2: int, m: int) -> Moment:
    """Empty moment of `n1` and `n2` dofs and `m` actuators."""
    sizes = (n1, n1, n2, n2, 2 * m, m, m, n1, n2, n1)
    return Moment(*(np.zeros(size) for size in sizes))


@called
def _quadratic(matrix, a, b):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(len(a)):
        for j in range(len(b)):
            total += a[i] * matrix[i, j] * b[j]
    return total


@called
def powers(bodies, at, out):  # type: ignore[no-untyped-def]
    """Powers (6,), in W, of the terms `TERMS` at a moment; (6, N) at N of them, columns of its signals."""
    outside = 0.0
    for i in range(at.v1.shape[0]):
        outside += at.v1[i] * at.free[i]
    listed = 0.0
    for i in range(at.v1.shape[0]):
        listed += at.v1[i] * at.w1[i]
    load = listed
    for i in range(at.v2.shape[0]):
        load = load + at.v2[i] * at.w2[i]
    out[NUM] = out[FF] = out[FX] = 0.0
    damping = _quadratic(bodies.c1, at.v1, at.v1) + _quadratic(bodies.c2, at.v2, at.v2)
    actuators = 0.0
    m = bodies.stiffness.size
    for a in range(m):
        x1, v1, x2, v2 = (
            at.x1[bodies.plant[a]],
            at.v1[bodies.plant[a]],
            at.x2[bodies.numerical[a]],
            at.v2[bodies.numerical[a]],
        )
        k, c = bodies.stiffness[a], bodies.damping[a]
        force = -c * (v1 - v2) - k * (x1 - x2)
        seen = -c * (at.held[m + a] - v2) - k * (at.held[a] - x2)
        f_fx, f_ff = bodies.k_tot[a] * (at.u_fx[a] - x1), bodies.k_tot[a] * at.u_ff[a]
        out[NUM] += v2 * (force - seen)
        out[FF] += v1 * (f_ff - force)
        out[FX] += v1 * f_fx
        actuators += v1 * (f_fx + f_ff)
        damping += c * (v1 - v2) * (v1 - v2)
    out[DAMPING] = -damping
    out[LOAD] = load
    out[EFFECTS] = outside - listed - actuators


@called
def total_energy(bodies, x1, v1, x2, v2):  # type: ignore[no-untyped-def]
    """Kinetic and potential energy of the masses and the springs, in J."""
    energy = (
        _quadratic(bodies.m1, v1, v1)
        + _quadratic(bodies.k1, x1, x1)
        + _quadratic(bodies.m2, v2, v2)
        + _quadratic(bodies.k2, x2, x2)
    )
    for a in range(bodies.stiffness.size):
        stretch = x1[bodies.plant[a]] - x2[bodies.numerical[a]]
        energy += bodies.stiffness[a] * stretch * stretch
    return 0.5 * energy


@called
def quintic(x0, v0, a0, x1, v1, a1, h, r):  # type: ignore[no-untyped-def]
    """Position and velocity at the fraction `r` of a step `h` on the quintic through position, velocity and
    acceleration at its ends.
    """
    d = x1 - x0
    b0, b1 = h * v0, h * v1
    c0, c1 = h * h * a0, h * h * a1
    p3 = 10.0 * d - 6.0 * b0 - 4.0 * b1 - 1.5 * c0 + 0.5 * c1
    p4 = -15.0 * d + 8.0 * b0 + 7.0 * b1 + 1.5 * c0 - c1
    p5 = 6.0 * d - 3.0 * b0 - 3.0 * b1 - 0.5 * c0 + 0.5 * c1
    x = x0 + r * (b0 + r * (0.5 * c0 + r * (p3 + r * (p4 + r * p5))))
    v = (b0 + r * (c0 + r * (3.0 * p3 + r * (4.0 * p4 + r * 5.0 * p5)))) / h
    return x, v


@called
def cubic(y0, dy0, y1, dy1, h, r):  # type: ignore[no-untyped-def]
    """Value at the fraction `r` of a step `h` on the cubic through value and slope at its ends."""
    d = y1 - y0
    return y0 + r * (h * dy0 + r * (3.0 * d - h * (2.0 * dy0 + dy1) + r * (h * (dy0 + dy1) - 2.0 * d)))


@called
def cubic_slope(y0, dy0, y1, dy1, h, r):  # type: ignore[no-untyped-def]
    """Slope of `cubic` at the fraction `r` of a step `h`; that at the start where the step has no length."""
    if h <= 0.0:
        return dy0
    d = (y1 - y0) / h
    return dy0 + r * (6.0 * d - 4.0 * dy0 - 2.0 * dy1 + r * (3.0 * (dy0 + dy1) - 6.0 * d))


@compiled_in_place
def total_energy_of(bodies: Bodies, x1: Floats, v1: Floats, x2: Floats, v2: Floats) -> float:
    """Kinetic and potential energy, in J (compiled face)."""
    return total_energy(bodies, x1, v1, x2, v2)  # type: ignore[no-any-return]


def delay_matrices(spec: Spec) -> tuple[Floats, Floats]:
    """M_tau and C_tau of the first-order approximation (26a) and (26b): the parts of mass and damping that
    the delays add.

    Rows and columns are the plant dofs, then the numerical dofs; tau' as in (20). Exact in the paper for one
    dof and one actuator a side, and written
    here for every actuator by itself. A compensator takes the terms of the plant's rows out.
    """
    mass, damping = delay_terms(spec)
    return np.asarray(mass.sum(axis=0)), np.asarray(damping.sum(axis=0))


def delay_terms(spec: Spec) -> tuple[Floats, Floats]:
    """M_tau and C_tau (3, n1 + n2, n1 + n2) by the error that they stand for: `NUM`, `FF`, `FX`."""
    loop, sides = spec.loop(), interface(spec)
    timing, n1, n2 = loop.timing, len(loop.plant.dofs), len(loop.numerical.dofs)
    tau1 = timing.tau1 + 0.5 * (timing.td1 + timing.td3)
    tau2 = timing.tau2 + 0.5 * (timing.td1 + timing.td2)
    tau3 = timing.tau3 + 0.5 * (timing.td2 + timing.td4)
    tau14, tau234, tau34 = tau1 + timing.tau4, tau2 + timing.tau3 + timing.tau4, tau3 + timing.tau4
    if loop.actuator.compensator != "none":
        tau14 = tau234 = tau34 = 0.0
    mass, damping = np.zeros((3, n1 + n2, n1 + n2)), np.zeros((3, n1 + n2, n1 + n2))
    for a in range(sides.actuators):
        i, j = int(sides.plant[a]), n1 + int(sides.numerical[a])
        k, c = float(sides.stiffness[a]), float(sides.damping[a])
        mass[NUM, j, i] += c * tau2
        mass[FF, i, i] -= c * tau234
        mass[FF, i, j] += c * tau34
        damping[NUM, j, i] += k * tau2
        damping[FF, i, i] -= k * tau234
        damping[FF, i, j] += k * tau34
        damping[FX, i, i] += spec.k_tot[a] * tau14
    return mass, damping


def power_forms(bodies: Bodies, at: Moment) -> Floats:
    """Powers, and last the energy, as quadratic forms (7, d, d), symmetric, of a state.

    Parameters
    ----------
    bodies
    at
        What a unit of each state is in every signal: arrays (., d).
    """
    d = at.x1.shape[1]
    i, j = np.tril_indices(d)
    each = Moment(*(rows[:, i] + np.where(i == j, 0.0, rows[:, j]) for rows in at))
    found = np.empty((len(TERMS) + 1, i.size))
    uncompiled(powers)(bodies, each, found)
    found[-1] = uncompiled(total_energy)(bodies, each.x1, each.v1, each.x2, each.v2)
    own = found[:, i == j]
    forms = np.empty((len(TERMS) + 1, d, d))
    forms[:, i, j] = np.where(i == j, found, 0.5 * (found - own[:, i] - own[:, j]))
    forms[:, j, i] = forms[:, i, j]
    return forms
