"""What can be wrong with a sensor; units follow the signal: position m, velocity m/s, force N."""

from __future__ import annotations

from rthm_core.effects.base import Effect, EffectParameter, register


@register
class Bias(Effect):
    """Constant error."""

    kind = "bias"
    blocks = ("sensor",)
    parameters = {"bias": EffectParameter("signal", "reading at a true value of zero")}
    equation = "y = s + bias"
    words = "{block} of {dof} reads what is true plus {bias}"


@register
class Scale(Effect):
    """Wrong gain."""

    kind = "scale"
    blocks = ("sensor",)
    parameters = {"scale": EffectParameter("1", "reading over true value; 1 is right", above=0.0)}
    equation = "y = scale s"
    words = "{block} of {dof} reads {scale} times the true value"


@register
class Drift(Effect):
    """Error that grows with time from zero at the start of the test."""

    kind = "drift"
    blocks = ("sensor",)
    parameters = {"rate": EffectParameter("signal/s", "growth of the error")}
    equation = "y = s + rate t"
    depends_on = ("t",)
    words = "{block} of {dof} drifts by {rate}"


@register
class SensorLag(Effect):
    """First-order low pass, as of an analogue filter."""

    kind = "lag"
    blocks = ("sensor",)
    parameters = {"time_constant": EffectParameter("s", "time constant of the filter", above=0.0)}
    equation = "time_constant dy/dt = s - y"
    words = "{block} of {dof} is filtered with a lag of {time_constant}"
    states = 1


@register
class SensorQuantisation(Effect):
    """Readings rounded to the resolution of the converter."""

    kind = "quantisation"
    blocks = ("sensor",)
    parameters = {"step": EffectParameter("signal", "resolution of the reading", above=0.0)}
    equation = "y = step round(s / step)"
    words = "{block} of {dof} reads in steps of {step}"
