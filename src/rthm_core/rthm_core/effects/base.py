"""What every kind of effect declares, and the registry in which every part of the system finds it.

An effect is one class in one module of this package. The spec checks its parameters, the simulator and the
plant node compute with it, the diagnosis looks for it, the reference page prints it: from one declaration::

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

import importlib
import pkgutil
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from string import Formatter
from typing import ClassVar, TypeVar

from rthm_core.effects.guess import Guess, Signals
from rthm_core.effects.possible import Plainer, Possible, Values, identified
from rthm_core.errors import RefusedError, suggestion
from rthm_core.quantity import Quantity, Text

EffectParameter = Quantity
"""A number of an effect: unit, description, bounds, default."""

EffectText = Text
"""An entry of an effect that is text."""

LINKS = ("tau1", "tau2", "tau3", "tau4")
SENSORS = {"position": "m", "velocity": "m/s", "force": "N"}
BLOCKS = (
    "plant",
    "wire",
    "motor",
    "numerical",
    "controller",
    *(f"link.{name}" for name in LINKS),
    *(f"sensor.{name}" for name in SENSORS),
)
"""Where an effect may sit (contract, section 6)."""

PLACES = {
    "plant": "dof",
    "wire": "actuator",
    "motor": "actuator",
    "sensor.position": "dof",
    "sensor.velocity": "dof",
    "sensor.force": "actuator",
}
"""Which key of the spec names the place within a block; blocks that are one thing have none."""


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
    depends_on
        Variables of its law, in the words of the contract (``x v a t u command load``).
    jump
        Parameter that is half the jump of its force where the motion turns, of dry friction; else empty.
    words
        What it is, for a test engineer; ``{force}`` becomes value and unit, ``{dof}``, ``{actuator}`` or
        ``{block}`` the place.
    states
        Number of internal states.
    possible
        Parameters that have narrower bounds in a fit than in a spec: what is physically possible, and what a
        recording can show. In this order; bounds may depend on the parameters before.
    secondary
        Parameters without which it is still this kind, whether they are identified or not.
    plainer
        Kinds that it may stand for: the first that predicts unseen data as well takes its place.
    flexible
        Whether it has enough freedom to imitate others, so that simpler ones are preferred to it.
    """

    kind: ClassVar[str]
    blocks: ClassVar[tuple[str, ...]]
    parameters: ClassVar[Mapping[str, EffectParameter | EffectText]] = {}
    equation: ClassVar[str] = ""
    depends_on: ClassVar[tuple[str, ...]] = ()
    jump: ClassVar[str] = ""
    words: ClassVar[str] = ""
    states: ClassVar[int] = 0
    possible: ClassVar[Mapping[str, Possible]] = {}
    secondary: ClassVar[tuple[str, ...]] = ()
    plainer: ClassVar[tuple[Plainer, ...]] = ()
    flexible: ClassVar[bool] = False

    @classmethod
    def guesses(cls, signals: Signals) -> Iterable[Guess]:
        """Where a fit may begin, given what a recording shows; none: the diagnosis does not look for it."""
        return ()

    @classmethod
    def identified(cls, values: Values, stds: Values) -> bool:
        """Whether values with these standard deviations make it this kind and no plainer one."""
        return identified(values, {name: std for name, std in stds.items() if name not in cls.secondary})

    @classmethod
    def unit(cls, parameter: str, block: str) -> str:
        """SI unit of a parameter in `block`; that of a sensor's effect follows the sensor's signal."""
        entry = cls.parameters[parameter]
        if isinstance(entry, Text):
            return ""
        return entry.unit.replace("signal", SENSORS.get(block.removeprefix("sensor."), "signal"))

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


E = TypeVar("E", bound=type[Effect])

_EFFECTS: dict[tuple[str, str], type[Effect]] = {}


def register(declared: E) -> E:
    """Make a kind known in each of its families of blocks; a class decorator."""
    fields = {name for _, name, _, _ in Formatter().parse(declared.words) if name}
    unknown = fields - {*declared.parameters, "dof", "actuator", "block"}
    if unknown:
        raise TypeError(f"the words of {declared.kind} use {sorted(unknown)}, which are not parameters of it")
    for family in declared.blocks:
        if _EFFECTS.setdefault((family, declared.kind), declared) is not declared:
            raise TypeError(f"{declared.kind} is declared twice for {family}")
    return declared


@cache
def _load() -> None:
    """Import every module of this package, so that its kinds are registered."""
    for module in pkgutil.iter_modules([str(Path(__file__).parent)]):
        importlib.import_module(f"{__package__}.{module.name}")


def _load_installed() -> None:
    """Import every module of this package, and what installed packages announce, once."""
    _load()
    from rthm_core.effects.own import load_installed  # checks laws, which are derived from this module's base

    load_installed()


def declared() -> tuple[type[Effect], ...]:
    """Every kind that is known now, shipped or not."""
    _load()
    return tuple(dict.fromkeys(_EFFECTS.values()))


def forget(some: Iterable[type[Effect]]) -> None:
    """Take kinds out that were registered by what then failed."""
    gone = set(some)
    for key in [key for key, one in _EFFECTS.items() if one in gone]:
        del _EFFECTS[key]


def shipped(block: str) -> tuple[type[Effect], ...]:
    """Kinds of a block that come with this package, in alphabetical order."""
    own = (one for one in declared() if one.__module__.startswith(f"{__package__}."))
    return tuple(sorted((one for one in own if block in one.blocks), key=lambda one: one.kind))


def family(block: str) -> str:
    """Family of a block: ``link`` of ``link.tau1``."""
    return block.partition(".")[0]


def check_block(block: object) -> str:
    """Return a block's name; raise RefusedError if there is none of this name."""
    if block not in BLOCKS:
        raise RefusedError(block, f"one of {', '.join(BLOCKS)}", suggestion(str(block), BLOCKS))
    return str(block)


def kinds(block: str) -> tuple[str, ...]:
    """Kinds of effect that `block` can have, in alphabetical order."""
    check_block(block)
    _load_installed()
    return tuple(sorted(kind for where, kind in _EFFECTS if where == family(block)))


def effect(kind: str, block: str) -> type[Effect]:
    """Effect of a `kind` in a `block`.

    Raises
    ------
    RefusedError
        If the block is not known or has no such kind; names those that it has.
    """
    check_block(block)
    _load()
    found = _EFFECTS.get((family(block), kind))
    if found is None:
        known = kinds(block)
        found = _EFFECTS.get((family(block), kind))
    if found is None:
        allowed = f"a kind that {block} knows ({', '.join(known)})"
        raise RefusedError(kind, allowed, suggestion(str(kind), known), "kind")
    return found
