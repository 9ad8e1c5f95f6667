"""The motor: u = h(s) u_d(t - tau4), and what can be wrong with it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from benchmarks.concealed.states import LAG, POLE_A, POLE_V, SECOND, SECOND_RATE, SLEW
from numba import njit


class Motor(NamedTuple):
    """Parameters; zero switches a part off, infinity a limit."""

    kv: float  # rad/s; 0: h(s) = 1
    ka: float
    lag: float  # s
    frequency: float  # rad/s
    damping_ratio: float
    rate: float  # m/s
    limit: float  # m
    step: float  # m
    screw: float  # m, error of the screw once per `pitch`
    pitch: float  # m
    creep: float  # m/s, as of a part that warms up


@njit
def accepted(t: float, command: float, motor: Motor) -> float:
    """Command as the drive takes it at t: rounded to its step, cut at its limit; in m."""
    if motor.pitch > 0.0:
        command += motor.screw * np.sin(2.0 * np.pi * command / motor.pitch)
    command += motor.creep * t
    if motor.step > 0.0:
        command = np.round(command / motor.step) * motor.step
    return min(max(command, -motor.limit), motor.limit)


@njit
def slewed(command: float, elapsed: float, memory: np.ndarray, motor: Motor) -> float:
    """Output of the rate limit `elapsed` seconds after the memory was last brought up to date."""
    if motor.rate == np.inf:
        return command
    reach = motor.rate * elapsed
    return memory[SLEW] + min(max(command - memory[SLEW], -reach), reach)


@njit
def arrival(command: float, memory: np.ndarray, motor: Motor) -> float:
    """Seconds until the rate limit has caught up with the command; infinity when it has."""
    behind = abs(command - memory[SLEW])
    return behind / motor.rate if motor.rate != np.inf and behind > 0.0 else np.inf


@njit
def position(slew: float, y: np.ndarray, motor: Motor) -> float:
    """Motor position u, in m."""
    if motor.kv > 0.0:
        return y[POLE_A]
    if motor.frequency > 0.0:
        return y[SECOND]
    return y[LAG] if motor.lag > 0.0 else slew


@njit
def speed(slew: float, command: float, y: np.ndarray, motor: Motor) -> float:
    """Rate of the motor position, in m/s; its jumps are not in it."""
    if motor.kv > 0.0:
        return motor.ka * (y[POLE_V] - y[POLE_A])
    if motor.frequency > 0.0:
        return y[SECOND_RATE]
    if motor.lag > 0.0:
        return (slew - y[LAG]) / motor.lag
    return motor.rate * np.sign(command - slew) if motor.rate != np.inf else 0.0


@njit
def rates(slew: float, y: np.ndarray, motor: Motor, dy: np.ndarray) -> None:
    """Lag, second order and the two poles, one after the other."""
    u = slew
    if motor.lag > 0.0:
        dy[LAG] = (u - y[LAG]) / motor.lag
        u = y[LAG]
    if motor.frequency > 0.0:
        dy[SECOND] = y[SECOND_RATE]
        dy[SECOND_RATE] = (
            motor.frequency**2 * (u - y[SECOND])
            - 2.0 * motor.damping_ratio * motor.frequency * y[SECOND_RATE]
        )
        u = y[SECOND]
    if motor.kv > 0.0:
        dy[POLE_V] = motor.kv * (u - y[POLE_V])
        dy[POLE_A] = motor.ka * (y[POLE_V] - y[POLE_A])
