"""Equations of the actuator and of the two masses: (5), (8), (10), (7) and (11a)."""

from __future__ import annotations

import numpy as np

from rthm_analysis.reproduce.candidates import loop
from rthm_analysis.reproduce.errata.erratum import Erratum
from rthm_core.engine.coupled.body import coupled_body
from rthm_core.physical.side import PhysicalSide
from rthm_core.spec import apply, shipped_spec

POLES = (40.0, 200.0)
"""A slow motor, so that h(s) is seen, rad/s."""


def stiffness_of_the_transmission() -> Erratum:
    """(5), against the rest position of the pulley that (3a) gives."""
    transmission = shipped_spec("transmission").loop().actuator.transmission
    assert transmission is not None
    k_theta, k_w, r = transmission.spring, transmission.wire, transmission.radius
    motor, x1 = 2.0, 0.01
    pulley = (k_theta * motor + r * k_w * x1) / (k_theta + r**2 * k_w)
    statics = k_w * (r * pulley - x1) / (r * motor - x1)
    printed, corrected = 1.0 / (1.0 / k_w + 1.0 / (k_theta * r)), transmission.k_tot
    return Erratum(
        "(5)",
        "1/(k_theta r_w)",
        "r_w^2 / k_theta",
        "k_tot against the statics of (3a), relative",
        abs(printed / statics - 1.0),
        abs(corrected / statics - 1.0),
    )


def _ideal() -> tuple[np.ndarray, np.ndarray, float, float]:
    spec = loop()
    body, face = coupled_body(spec, "ideal"), spec.loop().interface
    return body.damping, body.stiffness, face.damping[0], face.stiffness[0]


def damper_of_the_interface() -> Erratum:
    """(8) and (10c), against (26b) without delays, which is right as printed."""
    damping, _, c2, _ = _ideal()
    from_printed, from_corrected = 0.0, -c2  # derivative of F_c by v1, with c2 on position or on velocity
    expected = damping[0, 1]
    return Erratum(
        "(8a,b), (10c)",
        "c2 times the relative position",
        "c2 times the relative velocity",
        "derivative of F_c by v1 against C(1,2) of (26b) without delays, Ns/m",
        abs(from_printed - expected),
        abs(from_corrected - expected),
    )


def spring_of_the_second_mass() -> Erratum:
    """(10b), against (26c)."""
    _, stiffness, _, k2 = _ideal()
    k3 = loop().loop().numerical.stiffness[0]
    return Erratum(
        "(10b)",
        "x1",
        "x2",
        "stiffness that mass 2 feels to its own motion against K(2,2) of (26c), N/m",
        abs(k2 - stiffness[1, 1]),
        abs(k2 + k3 - stiffness[1, 1]),
    )


def motor_in_the_time_domain() -> Erratum:
    """(7) and (11a): the motor's answer to a step, against the convolution with h's impulse response."""
    spec = apply(loop(), {"actuator.motor_poles": list(POLES)})
    side, step, at = PhysicalSide(spec), 0.1, 0.020
    first = side.sample(0).motor_position[0]
    side.command(0, np.array([first + step]))
    reached = side.sample(round(at * 1e9)).motor_position[0]
    nodes, weights = np.polynomial.legendre.leggauss(40)
    kv, ka = POLES
    s = 0.5 * at * (nodes + 1.0)
    impulse = kv * ka / (ka - kv) * (np.exp(-kv * s) - np.exp(-ka * s))
    convolved = first + step * 0.5 * at * float(weights @ impulse)
    return Erratum(
        "(7), (11a)",
        "time and Laplace domain mixed: u = u_d(t, tau4) h(s)",
        "convolution with the impulse response of h, or all in s",
        "position of the simulated motor 20 ms after a step against the convolution, m",
        None,
        abs(reached - convolved),
    )


CHECKS = (
    stiffness_of_the_transmission,
    damper_of_the_interface,
    spring_of_the_second_mass,
    motor_in_the_time_domain,
)
