"""What can be wrong with a sensor; units follow the signal: position m, velocity m/s, force N."""

from __future__ import annotations

from collections.abc import Iterator

from rthm_core.effects.declaration import Effect, EffectParameter
from rthm_core.effects.guess import Guess, SensorSignals
from rthm_core.effects.registry import register

PART = 0.3
"""Part of the noise by which a reading is changed in a trial."""


@register
class Bias(Effect):
    """Constant error."""

    kind = "bias"
    blocks = ("sensor",)
    parameters = {"bias": EffectParameter("signal", "reading at a true value of zero")}
    equation = "y = s + bias"
    words = "{block} of {dof} has an offset of {bias}"
    experiment = (
        "Rest {place} at a position, or under a force, that is known, and read the sensor for ten seconds."
    )
    changes = "offset"
    additive = True
    rank = 10

    @classmethod
    def guesses(cls, signals: SensorSignals) -> Iterator[Guess]:
        """Linear, of either sign."""
        yield Guess({"bias": PART * signals.noise}, ("bias",), signed=True)


@register
class Scale(Effect):
    """Wrong gain."""

    kind = "scale"
    blocks = ("sensor",)
    parameters = {"scale": EffectParameter("1", "reading over true value; 1 is right", above=0.0)}
    equation = "y = scale s"
    words = "{block} of {dof} reads {scale} times the true value"
    experiment = "Rest {place} at three known positions, or under three known forces, on both sides of zero."
    changes = "gain"
    linear = True
    rank = 20

    @classmethod
    def guesses(cls, signals: SensorSignals) -> Iterator[Guess]:
        """Linear in what it differs from one, either way."""
        yield Guess(
            {"scale": 1.0 + PART * signals.noise / signals.spread}, ("scale",), signed=True, neutral=1.0
        )


@register
class Drift(Effect):
    """Error that grows with time from zero at the start of the test."""

    kind = "drift"
    blocks = ("sensor",)
    parameters = {"rate": EffectParameter("signal/s", "growth of the error")}
    equation = "y = s + rate t"
    depends_on = ("t",)
    words = "{block} of {dof} drifts by {rate}"
    experiment = "Record {place} at rest for as long as the test took, after the same warm-up."
    changes = "growth"
    additive = True
    rank = 30

    @classmethod
    def guesses(cls, signals: SensorSignals) -> Iterator[Guess]:
        """Linear, of either sign."""
        yield Guess({"rate": PART * signals.noise / signals.duration}, ("rate",), signed=True)


@register
class SensorLag(Effect):
    """First-order low pass, as of an analogue filter."""

    kind = "lag"
    blocks = ("sensor",)
    parameters = {"time_constant": EffectParameter("s", "time constant of the filter", above=0.0)}
    equation = "time_constant dy/dt = s - y"
    words = "{block} of {dof} is filtered with a lag of {time_constant}"
    experiment = "Record steps of {place} together with a faster sensor, or ask the amplifier for its filter."
    states = 1
    changes = "smoothing"
    linear = True
    rank = 40

    @classmethod
    def guesses(cls, signals: SensorSignals) -> Iterator[Guess]:
        """Linear in a short time constant."""
        short = min(PART * signals.noise / max(signals.rate, 1e-300), 1e-3)
        yield Guess({"time_constant": short}, ("time_constant",))


@register
class SensorQuantisation(Effect):
    """Readings rounded to the resolution of the converter."""

    kind = "quantisation"
    blocks = ("sensor",)
    parameters = {"step": EffectParameter("signal", "resolution of the reading", above=0.0)}
    equation = "y = step round(s / step)"
    words = "{block} of {dof} reads in steps of {step}"
    experiment = (
        "Move {place} very slowly over ten steps of the reading, and look up the resolution of the converter."
    )
    changes = "step"
