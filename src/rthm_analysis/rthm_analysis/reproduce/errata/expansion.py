"""The Taylor expansions: (16), (23) and (24a), against what they expand, at s = i omega."""

from __future__ import annotations

import numpy as np

from rthm_analysis.reproduce.candidates import loop
from rthm_analysis.reproduce.errata.erratum import Erratum
from rthm_analysis.reproduce.errata.model import POLES

OMEGA = 1.0
"""A slow motion, for which a first-order expansion has to hold, rad/s."""


def primed() -> tuple[float, float, float]:
    """tau1' + tau4, tau2' + tau3 + tau4 and tau3' + tau4 of (20), s."""
    t = loop().loop().timing
    tau1, tau2, tau3 = (
        t.tau1 + 0.5 * (t.td1 + t.td3),
        t.tau2 + 0.5 * (t.td1 + t.td2),
        t.tau3 + 0.5 * t.td2,
    )
    return tau1 + t.tau4, tau2 + t.tau3 + t.tau4, tau3 + t.tau4


def _motor(s: complex) -> complex:
    kv, ka = POLES
    return 1.0 / ((1.0 + s / kv) * (1.0 + s / ka))


def remainder_of_the_series() -> Erratum:
    """(16), for f = exp(2 t) and N = 1: the remainder must be reached for some theta in [0, 1]."""
    t, tau, rate = 0.5, 0.1, 2.0
    f = np.exp(rate * t)
    remainder = np.exp(rate * (t - tau)) - (f - tau * rate * f)
    theta = np.linspace(0.0, 1.0, 2001)
    at = np.exp(rate * (t - theta * tau))
    printed, corrected = 0.5 * tau**2 * at**2, 0.5 * tau**2 * rate**2 * at
    return Erratum(
        "(16)",
        "power f^(N+1)",
        "derivative of order N+1",
        "nearest value over theta in [0, 1] to the true remainder for f = exp(2 t), relative",
        float(np.abs(printed / remainder - 1.0).min()),
        float(np.abs(corrected / remainder - 1.0).min()),
    )


def position_cancellation() -> Erratum:
    """(23), for a slow motor."""
    s, k_tot, (tau14, _, _) = 1j * OMEGA, loop().k_tot[0], primed()
    h = _motor(s)
    exact = k_tot * (h * np.exp(-s * tau14) - 1.0)
    printed = -k_tot * tau14 * s * h + (h - 1.0)
    corrected = -k_tot * tau14 * s * h + k_tot * (h - 1.0)
    return Erratum(
        "(23)",
        "(h - 1) x1, and k_tot twice",
        "k_tot (h - 1) x1, once",
        "F_fx against k_tot (h exp(-s tau) - 1) x1 at 1 rad/s with a slow motor, relative",
        float(abs(printed / exact - 1.0)),
        float(abs(corrected / exact - 1.0)),
    )


def force_feedforward() -> Erratum:
    """(24a), for a slow motor and both masses in motion."""
    s, face, (_, tau234, tau34) = 1j * OMEGA, loop().loop().interface, primed()
    k2, c2, h = face.stiffness[0], face.damping[0], _motor(s)
    x1, x2 = 0.5 + 0.0j, 0.2 + 0.1j
    v1, v2, a1, a2 = s * x1, s * x2, s * s * x1, s * s * x2
    whole = -k2 * (x1 - x2) - c2 * (v1 - v2)
    exact = -(k2 + c2 * s) * (x1 * np.exp(-s * tau234) - x2 * np.exp(-s * tau34)) * h
    printed = whole + (tau34 * (c2 * v2 + k2 * x2) - tau234 * (k2 * x1 + c2 * v1)) * h
    corrected = (whole + tau234 * (k2 * v1 + c2 * a1) - tau34 * (k2 * v2 + c2 * a2)) * h
    return Erratum(
        "(24a)",
        "sign, one derivative short, h missing on F_c",
        "[F_c + tau234' (k2 v1 + c2 a1) - (tau3' + tau4)(k2 v2 + c2 a2)] h",
        "F_ff against the delayed F_c at 1 rad/s with a slow motor, relative",
        float(abs(printed / exact - 1.0)),
        float(abs(corrected / exact - 1.0)),
    )


CHECKS = (remainder_of_the_series, position_cancellation, force_feedforward)
