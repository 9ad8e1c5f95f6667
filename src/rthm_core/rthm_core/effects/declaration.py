"""What every kind of effect declares.

An effect is one class in one module of this package. The spec checks its parameters, the simulator and the
plant node compute with it, the diagnosis looks for it and tells it, the reference page prints it: from one
declaration, and by what it declares, never by its name::

    @register
    class CoulombFriction(PlantLaw):
        kind = "coulomb_friction"
        blocks = ("plant",)
        parameters = {"force": EffectParameter("N", "friction force", minimum=0.0)}
        equation = "F = -F_f sign(v)"
        words = "dry friction of {force} acts on {dof}"

Kinds of a user's own are declared in the same way, in a file of his (`rthm_core.effects.own`) or in a package
that announces its modules in the group of entry points ``rthm.effects``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Literal

from rthm_core.effects.blocks import SENSORS
from rthm_core.effects.guess import Guess
from rthm_core.effects.possible import Plainer, Possible, Twin, Values, identified
from rthm_core.quantity import Quantity, Text

EffectParameter = Quantity
"""A number of an effect: unit, description, bounds, default."""

EffectText = Text
"""An entry of an effect that is text."""

Change = Literal[
    "", "delay", "spread", "lost", "stamps", "element", "command", "step", "limit", "rate", "gain", "offset",
    "growth", "smoothing", "entry", "pretension",
]  # fmt: skip
"""What of its block an effect changes: of a link the delay, its spread, the part that is lost, and the
stamps; of a motor the delay, an element of its chain, its command, and step, limit and rate of that; of a
sensor gain, offset, growth of the offset, smoothing and step of its reading; of a block that computes an
entry of the spec; of a wire the pretension.
"""


class Effect:
    """Optional physics of one kind.

    Attributes
    ----------
    kind
        Its name in the spec.
    blocks
        Families of blocks in which it may sit: ``plant``, ``wire``, ``motor``, ``numerical``, ``controller``,
        ``link``, ``sensor``.
    parameters
        What it needs, in the order in which compiled code gets it.
    equation
        The formula, with the sign of the contract.
    words
        What it is, for a test engineer; ``{force}`` becomes value and unit, ``{dof}``, ``{actuator}`` or
        ``{block}`` the place.
    noun
        What it is called within a sentence; empty: its kind says that.
    experiment
        What a person may do to see it by itself, with ``{place}`` and ``{name}`` (of a link, or of an entry).
    depends_on
        Variables of its law, in the words of the contract (``x v a t u command load``).
    states
        Number of internal states.
    changes
        What of its block its first parameter, or all of it, changes; empty for laws of force.
    linear
        Whether it is linear and constant in time.
    additive
        Whether it only adds something that depends on nothing but time: it moves a loop without changing its
        dynamics.
    jump
        Parameter that is half the jump of its force where the motion turns, of dry friction; else empty.
    power
        Power of the position to which its force is proportional, of the terms of a spring; else None.
    is_tone
        Whether it is a force of one frequency, with the parameters amplitude, frequency and phase.
    kinked
        Whether its force has kinks that nothing locates but short steps.
    cost
        Work of a step with it, in steps with most others.
    rank
        Its place in the order in which a search tries the kinds of a block; by name among equals.
    possible
        Parameters that have narrower bounds in a fit than in a spec: what is physically possible, and what a
        recording can show. In this order; bounds may depend on the parameters before.
    secondary
        Parameters without which it is still this kind, whether they are identified or not.
    powers
        Parameters that go with a power of a size, and the parameter that is its exponent: what must be
        identified is the size.
    within
        Parameters that must be known better than to half their value, and to which part of it.
    along
        Parameters of either sign that are sizes in the same unit as a positive one, by which they are
        measured: a fit moves their ratio.
    plainer
        Kinds that it may stand for: the first that predicts unseen data as well takes its place.
    twins
        Kinds whose force is nearly the same: that which predicts unseen data best is named.
    flexible
        Whether it has enough freedom to imitate others, so that simpler ones are preferred to it.
    repeats
        Whether a rig may have several of it at one place.
    common
        Whether most rigs have a little of it.
    between_dofs
        Whether it is looked for between two dofs, too.
    written
        Whether its law is written in the spec, so that `given` makes it.
    shown_by
        Variable over which a free curve of the missing force has to be told before it is looked for; empty:
        it is always looked for.
    """

    kind: ClassVar[str]
    blocks: ClassVar[tuple[str, ...]]
    parameters: ClassVar[Mapping[str, EffectParameter | EffectText]] = {}
    equation: ClassVar[str] = ""
    words: ClassVar[str] = ""
    noun: ClassVar[str] = ""
    experiment: ClassVar[str] = ""
    depends_on: ClassVar[tuple[str, ...]] = ()
    states: ClassVar[int] = 0
    changes: ClassVar[Change] = ""
    linear: ClassVar[bool] = False
    additive: ClassVar[bool] = False
    jump: ClassVar[str] = ""
    power: ClassVar[int | None] = None
    is_tone: ClassVar[bool] = False
    kinked: ClassVar[bool] = False
    cost: ClassVar[int] = 1
    rank: ClassVar[int] = 1000
    possible: ClassVar[Mapping[str, Possible]] = {}
    secondary: ClassVar[tuple[str, ...]] = ()
    powers: ClassVar[Mapping[str, str]] = {}
    within: ClassVar[Mapping[str, float]] = {}
    along: ClassVar[Mapping[str, str]] = {}
    plainer: ClassVar[tuple[Plainer, ...]] = ()
    twins: ClassVar[tuple[Twin, ...]] = ()
    flexible: ClassVar[bool] = False
    repeats: ClassVar[bool] = False
    common: ClassVar[bool] = False
    between_dofs: ClassVar[bool] = False
    written: ClassVar[bool] = False
    shown_by: ClassVar[str] = ""

    @classmethod
    def given(cls, values: Mapping[str, Any]) -> type[Effect]:
        """What it is with these parameters; of most kinds the same whatever they are."""
        return cls

    @classmethod
    def guesses(cls, signals: Any) -> Iterable[Guess]:
        """Where a fit may begin, given what a recording shows; none: the diagnosis does not look for it.

        Parameters
        ----------
        signals : Signals, MotorSignals or SensorSignals
            What is recorded where it may sit (`rthm_core.effects.guess`).
        """
        return ()

    @classmethod
    def identified(cls, values: Values, stds: Values) -> bool:
        """Whether values with these standard deviations make it this kind and no plainer one."""
        main = {name: std for name, std in stds.items() if name not in cls.secondary}
        for name in main.keys() & cls.powers.keys():
            main[name] /= float(values.get(cls.powers[name], 1.0))
        return identified(values, main, cls.within)

    @classmethod
    def unit(cls, parameter: str, block: str) -> str:
        """SI unit of a parameter in `block`; that of a sensor's effect follows the sensor's signal."""
        entry = cls.parameters[parameter]
        if isinstance(entry, Text):
            return ""
        return entry.unit.replace("signal", SENSORS.get(block.removeprefix("sensor."), "signal"))

    @classmethod
    def called(cls) -> str:
        """What it is called within a sentence: ``dry friction``."""
        return cls.noun or cls.kind.replace("_", " ")

    @classmethod
    def describe(cls, block: str, place: str, values: Mapping[str, float | str]) -> str:
        """Return the words with values and place filled in."""
        texts = {name: cls._text(name, value, block) for name, value in values.items()}
        return cls.words.format(dof=place, actuator=place, block=block, **texts)

    @classmethod
    def _text(cls, name: str, value: float | str, block: str) -> str:
        if isinstance(value, str):
            return value
        unit = cls.unit(name, block)
        return f"{value:.4g}" if unit == "1" else f"{value:.4g} {unit}"
