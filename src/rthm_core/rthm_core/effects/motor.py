"""What a motor does beside ``h(s)`` and ``tau4``; sorted from the command to the position."""

from __future__ import annotations

from rthm_core.effects.base import Effect, EffectParameter, register
from rthm_core.effects.link import LONGEST, ExtraDelay


@register
class MotorExtraDelay(ExtraDelay):
    """Delay beside tau4; the same thing as an extra delay of link.tau4 seen through the recorded channels.

    A negative one makes the motor answer earlier than tau4 says.
    """

    kind = "extra_delay"
    blocks = ("motor",)
    parameters = {
        "delay": EffectParameter(
            "s", "delay that is added to tau4, no less than -tau4", minimum=-LONGEST, maximum=LONGEST
        )
    }
    equation = "u(t) = u_d(t - tau4 - delay)"
    depends_on = ("command",)
    words = "the motor of {actuator} answers {delay} later than the delay tau4 says"


@register
class MotorQuantisation(Effect):
    """Commands that the drive rounds to its own resolution."""

    kind = "quantisation"
    blocks = ("motor",)
    parameters = {"step": EffectParameter("m", "smallest change of the commanded position", above=0.0)}
    equation = "u = step round(u_d / step)"
    depends_on = ("command",)
    words = "the motor of {actuator} moves in steps of {step}"


@register
class MotorSaturation(Effect):
    """Position that the motor does not go beyond."""

    kind = "saturation"
    blocks = ("motor",)
    parameters = {
        "limit": EffectParameter("m", "largest distance from the zero position, either way", above=0.0)
    }
    equation = "u = min(max(u_d, -limit), limit)"
    depends_on = ("command",)
    words = "the motor of {actuator} goes no further than {limit} from its zero, either way"


@register
class MotorLag(Effect):
    """First-order lag behind the delay tau4, before h(s)."""

    kind = "lag"
    blocks = ("motor",)
    parameters = {"time_constant": EffectParameter("s", "time constant, after tau4", above=0.0)}
    equation = "time_constant du/dt = u_d(t - tau4) - u"
    depends_on = ("command",)
    words = "the motor of {actuator} follows its command with a lag of {time_constant}"
    states = 1


@register
class MotorSecondOrder(Effect):
    """Resonant servo: second-order low pass behind the delay tau4."""

    kind = "second_order"
    blocks = ("motor",)
    parameters = {
        "frequency": EffectParameter("rad/s", "natural frequency of the servo", above=0.0),
        "damping_ratio": EffectParameter("1", "damping ratio; below 1 the motor overshoots", above=0.0),
    }
    equation = "ddu + 2 zeta w du + w^2 u = w^2 u_d(t - tau4)"
    depends_on = ("command",)
    words = (
        "the motor of {actuator} follows its command as a resonant servo of {frequency} "
        "with a damping ratio of {damping_ratio}"
    )
    states = 2


@register
class MotorRateLimit(Effect):
    """Speed that the motor does not exceed."""

    kind = "rate_limit"
    blocks = ("motor",)
    parameters = {"rate": EffectParameter("m/s", "largest speed of the motor", above=0.0)}
    equation = "|du/dt| <= rate"
    depends_on = ("command",)
    words = "the motor of {actuator} moves no faster than {rate}"
    states = 1
