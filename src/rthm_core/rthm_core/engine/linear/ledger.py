"""The work of a linear loop, as tables: every power is a quadratic form of the joint state of both sides,
and so is its integral over a step.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.energy import EFFECTS, TERMS, Bodies, Moment, bodies, power_forms
from rthm_core.engine.general.ledger import nothing_added
from rthm_core.engine.linear.loop import LinearLoop, Side
from rthm_core.exponential import exponentials, rate_bound
from rthm_core.numerical import shared_numerical
from rthm_core.physical.drive import Drive, drive, settled
from rthm_core.physical.side import shared_model
from rthm_core.simd import simd_empty

if TYPE_CHECKING:
    from rthm_core.spec import Spec

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
COLUMNS = 8
"""Work of six terms, the energy, and one that makes the row as long as two registers."""


class LinearLedger(NamedTuple):
    """Powers of the terms `energy.TERMS`, and the energy, as forms of the joint state
    ``z = [plant, commands, numerical, held]``.

    Attributes
    ----------
    loop : LinearLoop
        The loop with its commands in two parts [u_fx, u_ff], and what h(s) makes of each as leading states.
    joint : (d, d) array
        Dynamics of z between two changes of an input.
    forms : (7, d, d) array
        Six powers in W and the energy in J.
    """

    loop: LinearLoop
    joint: Floats
    forms: Floats


def linear_ledger(spec: Spec, loop: LinearLoop) -> LinearLedger:
    """Ledger of a linear loop."""
    believed = drive(spec, effects=False)
    parted = _in_parts(loop, believed)
    one, two = parted.plant, parted.numerical
    n1, n2, m1, m2 = one.a.shape[0], two.a.shape[0], one.held.size, two.held.size
    joint = np.zeros((n1 + m1 + n2 + m2, n1 + m1 + n2 + m2))
    joint[:n1, :n1], joint[:n1, n1 : n1 + m1] = one.a, one.b
    at = n1 + m1
    joint[at : at + n2, at : at + n2], joint[at : at + n2, at + n2 :] = two.a, two.b
    forms = _forms(spec, parted, believed, joint)
    return LinearLedger(parted, joint, forms)


def _in_parts(loop: LinearLoop, believed: Drive) -> LinearLoop:
    """The loop with [u_fx, u_ff] as inputs; the states of h(s) for each part come first."""
    one, m = loop.plant, loop.k_tot.size
    chain, n = believed.system.a.shape[0], loop.plant.a.shape[0]
    a, b = np.zeros((2 * chain + n, 2 * chain + n)), np.zeros((2 * chain + n, 2 * m))
    for part in range(2):
        span = slice(part * chain, (part + 1) * chain)
        a[span, span], b[span, part * m : (part + 1) * m] = believed.system.a, believed.system.b
    a[2 * chain :, 2 * chain :], b[2 * chain :] = one.a, np.hstack([one.b, one.b])
    fx = loop.first_sample[:m]
    ff = one.held - fx
    y = np.concatenate([settled(believed, fx), settled(believed, ff), one.y])

    def parted(rows: Floats) -> Floats:
        return np.hstack([np.zeros((rows.shape[0], 2 * chain)), rows, rows[:, n:]])

    side = Side(a, b, y, np.concatenate([fx, ff]), one.exosystem)
    return loop._replace(
        plant=side, sample=parted(loop.sample), rows=parted(loop.rows), motors=parted(loop.motors)
    )


def _signals(spec: Spec, loop: LinearLoop, believed: Drive, joint: Floats, b: Bodies) -> Moment:
    """All signals of `energy.Moment` as rows over z."""
    model, side2 = shared_model(spec)[0], shared_numerical(spec)
    n1, n2, m, chain = model.n, side2.n, model.m, believed.system.a.shape[0]
    first, size = loop.plant.a.shape[0], joint.shape[0]
    second = first + 2 * m
    unit = np.eye(size)
    motion = np.zeros((2 * n1, size))
    motion[:, : first + 2 * m] = loop.rows[: 2 * n1]
    x1, v1 = motion[:n1], motion[n1:]
    parts = [
        believed.out @ np.vstack([unit[part * chain : (part + 1) * chain], unit[first + part * m :][:m]])
        for part in range(2)
    ]
    loads1, loads2 = np.zeros((n1, size)), np.zeros((n2, size))
    out1, out2 = loop.plant.exosystem.out, loop.numerical.exosystem.out
    for i in range(model.listed_loads):
        loads1[model.load_dof[i], first - out1.shape[1] : first] += out1[i]
    at = second + 2 * n2
    loads2[side2.load_dof[0], at : at + out2.shape[1]] = out2[0]
    velocity = int(np.flatnonzero(loop.rows[n1])[0])
    free = b.m1 @ joint[velocity : velocity + n1] + b.c1 @ v1 + b.k1 @ x1
    x2, held = unit[second : second + 2 * n2], unit[size - 2 * m :]
    return Moment(x1, v1, x2[:n2], x2[n2:], held, parts[0], parts[1], loads1, loads2, free)


def _forms(spec: Spec, loop: LinearLoop, believed: Drive, joint: Floats) -> Floats:
    b = bodies(spec)
    forms = power_forms(b, _signals(spec, loop, believed, joint, b))
    if nothing_added(spec, shared_model(spec)[0], believed):
        forms[EFFECTS] = 0.0
    return forms


def work_tables(ledger: LinearLedger, moves_ns: Integers, rows_ns: Integers) -> Floats:
    """Work over the lengths of moves, then that over the lengths before rows with the energy at their ends,
    as coefficients (K, d (d + 1) / 2, 8) of the products ``z_i z_j``, i <= j, of the state at the start.
    """
    return packed(work_and_energy(ledger, moves_ns, rows_ns))


def work_and_energy(ledger: LinearLedger, moves_ns: Integers, rows_ns: Integers) -> Floats:
    """Work over the lengths of moves, then that over the lengths before rows with the energy at their ends,
    as forms (K, 7, d, d) of the state at the start.
    """
    work, ends = work_over(ledger, np.concatenate([moves_ns, rows_ns])), exponentials(ledger.joint, rows_ns)
    energy = np.zeros_like(work[:, :1])
    energy[moves_ns.size :, 0] = np.swapaxes(ends, 1, 2) @ (ledger.forms[-1] @ ends)
    return np.concatenate([work, energy], axis=1)


def work_over(ledger: LinearLedger, lengths_ns: Integers) -> Floats:
    """Work (K, 6, d, d) over each of the lengths (K,) as forms of the state at its start: integrals
    ``E(t)' P E(t)`` of each power P, by quadrature in parts that are short beside the fastest motion.
    """
    d, powers, bound = ledger.joint.shape[0], ledger.forms[: len(TERMS), None], rate_bound(ledger.joint)
    forms = np.empty((lengths_ns.size, len(TERMS), d, d))
    for length, form in zip(lengths_ns.tolist(), forms, strict=True):
        parts = max(1, math.ceil(bound * length * 1e-9))
        nodes = (np.arange(parts)[:, None] + 0.5 * (NODES + 1.0)).ravel() * (length / parts)
        weights = np.tile(0.5e-9 * length / parts * WEIGHTS, parts)
        steps = exponentials(ledger.joint, nodes)
        pushed = powers @ (steps * weights[:, None, None])
        form[...] = steps.reshape(-1, d).T @ pushed.reshape(len(TERMS), -1, d)
    return forms


def packed(forms: Floats) -> Floats:
    """Tables (K, d (d + 1) / 2, 8) of forms (K, 6 or 7, d, d): the work, and the energy if it is there."""
    first, second, double = pairs(forms.shape[-1])
    tables = simd_empty(forms.shape[0], first.size, COLUMNS)
    tables[:, :, : forms.shape[1]] = np.swapaxes(forms[..., first, second] * double, 1, 2)
    tables[:, :, forms.shape[1] :] = 0.0
    return tables


@cache
def pairs(d: int) -> tuple[Integers, Integers, Floats]:
    """Every two of d elements, i <= j, and how often their product is in a form."""
    first, second = np.triu_indices(d)
    return first, second, np.where(first == second, 1.0, 2.0)
