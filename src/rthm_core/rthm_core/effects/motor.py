"""What a motor does beside ``h(s)`` and ``tau4``; sorted from the command to the position."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, NamedTuple

import numpy as np

from rthm_core.effects.declaration import Effect, EffectParameter
from rthm_core.effects.guess import Guess, MotorSignals
from rthm_core.effects.link import LONGEST_DELAY, ExtraDelay
from rthm_core.effects.possible import Values
from rthm_core.effects.registry import register


class Element(NamedTuple):
    """One element of the chain from command to position.

    Attributes
    ----------
    dynamics : (k, k) array
        Of its own states.
    entry, row : (k,) arrays
        What its input does to the states, and what of them is its output.
    """

    dynamics: Any
    entry: Any
    row: Any


def first_order(time_constant: float) -> Element:
    """Lag with a time constant in s."""
    return Element(np.array([[-1.0 / time_constant]]), np.array([1.0 / time_constant]), np.array([1.0]))


class MotorEffect(Effect):
    """What a motor does: an element of its chain, or one number of how it takes commands (`changes`).

    Attributes
    ----------
    harmless, gross
        Values of the first parameter that hardly matter, and that nobody could miss: between them lies what
        would just be seen.
    typical
        What the other parameters are meanwhile.
    """

    depends_on = ("command",)
    harmless: ClassVar[float]
    gross: ClassVar[float]
    typical: ClassVar[dict[str, float]] = {}

    @staticmethod
    def element(p: Values) -> Element | None:
        """Element of the chain with these parameters, by name; None: it is none."""
        return None

    @staticmethod
    def shift(u: float, t: float, p: list[float]) -> float:
        """Position that is added to a command `u` that is taken at time `t` (s), m; of what changes the
        command.
        """
        return 0.0


@register
class MotorExtraDelay(ExtraDelay, MotorEffect):
    """Delay beside tau4; the same thing as an extra delay of link.tau4 seen through the recorded channels.

    A negative one makes the motor answer earlier than tau4 says.
    """

    kind = "extra_delay"
    blocks = ("motor",)
    parameters = {
        "delay": EffectParameter(
            "s",
            "delay that is added to tau4, no less than -tau4",
            minimum=-LONGEST_DELAY,
            maximum=LONGEST_DELAY,
        )
    }
    equation = "u(t) = u_d(t - tau4 - delay)"
    words = "the motor of {actuator} answers {delay} later than the delay tau4 says"
    experiment = (
        "Step the command of {place} by a little with the dof locked, and compare the time to the "
        "first movement with tau4."
    )
    rank = 30
    harmless, gross = 1e-6, 0.1

    @classmethod
    def guesses(cls, signals: MotorSignals) -> Iterator[Guess]:
        """The delay that fits best: motors move in steps, so that no fit comes nearer."""
        delay, unsure = signals.delay()
        if delay != 0.0:
            yield Guess({"delay": delay}, fixed=("delay",), scales={"delay": unsure})


@register
class MotorQuantisation(MotorEffect):
    """Commands that the drive rounds to its own resolution."""

    kind = "quantisation"
    blocks = ("motor",)
    parameters = {"step": EffectParameter("m", "smallest change of the commanded position", above=0.0)}
    equation = "u = step round(u_d / step)"
    words = "the motor of {actuator} moves in steps of {step}"
    experiment = "Ramp the command of {place} very slowly."
    changes = "step"
    rank = 60
    harmless, gross = 1e-8, 1e-1

    @classmethod
    def guesses(cls, signals: MotorSignals) -> Iterator[Guess]:
        """The step that the rounding error has."""
        step = signals.step()
        if step:
            yield Guess({"step": step}, fixed=("step",))


@register
class MotorSaturation(MotorEffect):
    """Position that the motor does not go beyond."""

    kind = "saturation"
    blocks = ("motor",)
    parameters = {
        "limit": EffectParameter("m", "largest distance from the zero position, either way", above=0.0)
    }
    equation = "u = min(max(u_d, -limit), limit)"
    words = "the motor of {actuator} goes no further than {limit} from its zero, either way"
    experiment = "Ramp the command of {place} slowly to both ends with the dof free."
    changes = "limit"
    rank = 50
    harmless, gross = 1e1, 1e-5

    @classmethod
    def guesses(cls, signals: MotorSignals) -> Iterator[Guess]:
        """Positions that are hardly ever left, either way."""
        for share in (1.0, 0.99, 0.9):
            yield Guess({"limit": max(float(np.quantile(np.abs(signals.position), share)), 1e-9)})


@register
class MotorLag(MotorEffect):
    """First-order lag behind the delay tau4, before h(s)."""

    kind = "lag"
    blocks = ("motor",)
    parameters = {"time_constant": EffectParameter("s", "time constant, after tau4", above=0.0)}
    equation = "time_constant du/dt = u_d(t - tau4) - u"
    words = "the motor of {actuator} follows its command with a lag of {time_constant}"
    experiment = "Step the command of {place} by a little with the dof locked."
    states = 1
    changes = "element"
    linear = True
    rank = 10
    harmless, gross = 1e-6, 0.1

    @classmethod
    def guesses(cls, signals: MotorSignals) -> Iterator[Guess]:
        """Linear in a short time constant."""
        for time_constant in (2e-4, 1e-3, 5e-3):
            yield Guess({"time_constant": time_constant}, ("time_constant",))

    @staticmethod
    def element(p: Values) -> Element | None:
        """First-order lag."""
        return first_order(p["time_constant"]) if p["time_constant"] > 0.0 else None


@register
class MotorSecondOrder(MotorEffect):
    """Resonant servo: second-order low pass behind the delay tau4."""

    kind = "second_order"
    blocks = ("motor",)
    parameters = {
        "frequency": EffectParameter("rad/s", "natural frequency of the servo", above=0.0),
        "damping_ratio": EffectParameter("1", "damping ratio; below 1 the motor overshoots", above=0.0),
    }
    equation = "ddu + 2 zeta w du + w^2 u = w^2 u_d(t - tau4)"
    words = (
        "the motor of {actuator} follows its command as a resonant servo of {frequency} "
        "with a damping ratio of {damping_ratio}"
    )
    experiment = "Step the command of {place} by a little with the dof locked, and look for overshoot."
    states = 2
    changes = "element"
    linear = True
    rank = 20
    harmless, gross, typical = 1e5, 1.0, {"damping_ratio": 0.7}

    @classmethod
    def guesses(cls, signals: MotorSignals) -> Iterator[Guess]:
        """Slow to fast servos, none of which overshoots much."""
        for frequency in (15.0, 40.0, 120.0, 400.0, 1200.0, 3600.0):
            yield Guess({"frequency": frequency, "damping_ratio": 0.6})

    @staticmethod
    def element(p: Values) -> Element:
        """Second-order low pass."""
        w, zeta = p["frequency"], p["damping_ratio"]
        return Element(
            np.array([[0.0, 1.0], [-(w**2), -2.0 * zeta * w]]), np.array([0.0, w**2]), np.array([1.0, 0.0])
        )


@register
class MotorRateLimit(MotorEffect):
    """Speed that the motor does not exceed."""

    kind = "rate_limit"
    blocks = ("motor",)
    parameters = {"rate": EffectParameter("m/s", "largest speed of the motor", above=0.0)}
    equation = "|du/dt| <= rate"
    words = "the motor of {actuator} moves no faster than {rate}"
    experiment = "Step the command of {place} by several sizes, the dof locked: the slope must not grow."
    states = 1
    changes = "rate"
    rank = 40
    harmless, gross = 1e3, 1e-3

    @classmethod
    def guesses(cls, signals: MotorSignals) -> Iterator[Guess]:
        """Speeds that are hardly ever exceeded."""
        for share in (0.999, 0.99, 0.9):
            yield Guess({"rate": max(float(np.quantile(signals.speed, share)), 1e-6)})
