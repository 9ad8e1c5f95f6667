"""Energies of a system without a loop, by quadrature between its rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.energy import DAMPING, EFFECTS, FF, FX, GAUSS_WEIGHTS, LOAD, NUM, TERMS, delay_terms
from rthm_core.engine.coupled.body import coupled_body
from rthm_core.engine.coupled.motion import Motion
from rthm_core.substructure import Substructure

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def energies_of(
    spec: Spec,
    system: str,
    body: Substructure,
    rows: Motion,
    between: list[Motion],
    step: int,
    *,
    smooth: bool,
) -> dict[str, Floats]:
    """Work of all terms, by quadrature between the rows, and E_total.

    What the approximation adds to mass and damping stands for the errors of the loop. Where laws are not
    `smooth`, a force may jump between two rows: the work of the effects is then what the others leave over.
    """
    own = body if system == "hybrid" else coupled_body(spec, "ideal")
    errors = delay_terms(spec) if system == "taylor" else (np.zeros((3, *body.mass.shape)),) * 2
    work = np.zeros((len(TERMS), rows.x.shape[0]))
    for weight, motion in zip(GAUSS_WEIGHTS, between, strict=True):
        work[:, 1:] += weight * step * 1e-9 * _powers(body, own.damping, errors, motion)
    work = np.cumsum(work, axis=1)
    total = 0.5 * (_form(own.mass, rows.v, rows.v) + _form(own.stiffness, rows.x, rows.x))
    if not smooth:
        work[EFFECTS] += total - total[0] - work.sum(axis=0)
    return dict(zip(TERMS, work, strict=True)) | {"E_total": total}


def _powers(body: Substructure, damping: Floats, errors: tuple[Floats, Floats], motion: Motion) -> Floats:
    """Powers (6, rows) in the order of `TERMS`; what the known forces leave over is that of the effects."""
    x, v, a, w = motion
    found = np.empty((len(TERMS), x.shape[0]))
    for term in (NUM, FF, FX):
        found[term] = -_form(errors[0][term], v, a) - _form(errors[1][term], v, v)
    found[DAMPING], found[LOAD] = -_form(damping, v, v), np.einsum("ti,ti->t", v, w)
    inertia = _form(body.mass, v, a) + _form(body.damping, v, v) + _form(body.stiffness, v, x)
    found[EFFECTS] = inertia - found[LOAD]
    return found


def _form(matrix: Floats, a: Floats, b: Floats) -> Floats:
    """``a' matrix b`` of every row."""
    return np.asarray(np.einsum("ti,ij,tj->t", a, matrix, b, optimize=True))
