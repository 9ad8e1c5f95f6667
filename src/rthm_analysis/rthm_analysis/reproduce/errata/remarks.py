"""Table I's order, and what is right as printed: (26a) to (26c) and (28) to (30)."""

from __future__ import annotations

import numpy as np

from rthm_analysis.reproduce.candidates import loop
from rthm_analysis.reproduce.errata.erratum import Erratum
from rthm_analysis.reproduce.errata.expansion import primed
from rthm_analysis.response import response
from rthm_core.engine.coupled.body import coupled_body
from rthm_core.spec import shipped_spec

STATED_DAMPING = 0.66
"""Damping of the actuator's stiffness in the paper's text, Ns/m."""


def order_of_table_1() -> Erratum:
    """Td2 and Td3, by the damping that the text gives for the delayed stiffness of the actuator."""
    printed = shipped_spec("paper_printed").loop().timing
    k_tot = loop().k_tot[0]
    as_printed = k_tot * (printed.tau1 + 0.5 * (printed.td1 + printed.td3) + printed.tau4)
    return Erratum(
        "Table I",
        "Td2 = 4 ms, Td3 = 12 ms",
        "Td2 = 12 ms, Td3 = 4 ms",
        "k_tot (tau1' + tau4) against the text's 0.66 Ns/m, Ns/m",
        abs(as_printed - STATED_DAMPING),
        abs(k_tot * primed()[0] - STATED_DAMPING),
    )


def dynamic_stiffness(s: complex, tau2: float, tau14: float, tau234: float, tau34: float) -> np.ndarray:
    """M s^2 + C s + K of (28) and (29) with h = 1, word for word, N/m."""
    spec = loop()
    one, two, face = spec.loop().plant, spec.loop().numerical, spec.loop().interface
    c1, c2, c3 = one.damping[0], face.damping[0], two.damping[0]
    k1, k2, k3, k_tot = one.stiffness[0], face.stiffness[0], two.stiffness[0], spec.k_tot[0]
    e2, e14, e234, e34 = (np.exp(-tau * s) for tau in (tau2, tau14, tau234, tau34))
    mass = np.diag([one.mass[0], two.mass[0]])
    damping = np.array([[c1 + c2 * e234, -c2 * e34], [-c2 * e2, c2 + c3]])
    stiffness = np.array([[k1 + k_tot * (1.0 - e14) + k2 * e234, -k2 * e34], [-k2 * e2, k2 + k3]])
    return np.asarray(mass * s**2 + damping * s + stiffness)


def first_order_matrices() -> Erratum:
    """(26b) and (26c) are the first derivative and the value of (29) at s = 0."""
    t, (tau14, tau234, tau34), s = loop().loop().timing, primed(), 1e-4
    tau2 = t.tau2 + 0.5 * (t.td1 + t.td2)
    ahead, back = (dynamic_stiffness(sign * s, tau2, tau14, tau234, tau34) for sign in (1.0, -1.0))
    body = coupled_body(loop(), "taylor")
    slope, value = (ahead - back) / (2.0 * s), 0.5 * (ahead + back)
    return Erratum(
        "(26a) to (26c)",
        "right",
        "right; mass terms of (26a) mean little, as the expansion drops k_tot tau^2/2",
        "C and K against derivative and value of (29) with tau' at s = 0, Ns/m and N/m",
        float(max(np.abs(slope - body.damping).max(), np.abs(value - body.stiffness).max())),
        float(max(np.abs(slope - body.damping).max(), np.abs(value - body.stiffness).max())),
    )


def frequency_response() -> Erratum:
    """(28) to (30), word for word, against the loop of the project with pure delays."""
    t, omega = loop().loop().timing, np.array([1.0, 2.4, 5.0])
    ways = (t.tau2, t.tau1 + t.tau4, t.tau2 + t.tau3 + t.tau4, t.tau3 + t.tau4)
    computed = response(loop(), omega).ways["delays"]
    worst = 0.0
    for row, w in enumerate(omega):
        literal = np.linalg.inv(dynamic_stiffness(1j * w, *ways))
        worst = max(worst, float(np.abs(literal - computed[row]).max() / np.abs(literal).max()))
    return Erratum(
        "(28) to (30)",
        "right",
        "right; the holds are left out",
        "word for word against the response of the loop with pure delays at 1, 2.4 and 5 rad/s, relative",
        worst,
        worst,
    )


CHECKS = (order_of_table_1, first_order_matrices, frequency_response)
