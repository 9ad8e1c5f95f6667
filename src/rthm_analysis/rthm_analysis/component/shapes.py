"""What the force of a component may be made of: spring, damper, and the laws of the library.

A law along a known motion is a signal that depends on the parameters that shape it; how large it is, and how
an input scales it, are linear.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.component.along import force_along, substeps_for
from rthm_core.effects.guess import Guess, rms
from rthm_core.effects.possible import Seen
from rthm_core.effects.registry import ranked
from rthm_core.physical.laws import reads_load

if TYPE_CHECKING:
    from rthm_analysis.component.recorded import ComponentTest
    from rthm_core.compiled import Floats
    from rthm_core.effects import PlantLaw

OFFSET, SPRING, DAMPER = "offset", "stiffness", "damping"
"""Forces that a law is not needed for: constant, proportional to x, and to v."""

UNITS = {OFFSET: "N", SPRING: "N/m", DAMPER: "N s/m"}


class Power(NamedTuple):
    """A power of an input, lagged, by which a force is scaled; of no input: 1."""

    of: str = ""
    power: int = 1


ALWAYS = Power()


@dataclass(frozen=True)
class Shape:
    """One part of the force.

    Attributes
    ----------
    kind : str
        Of the library, or one of `UNITS`.
    law : type of PlantLaw or None
        None for a part that needs none.
    guess : Guess or None
        Parameters of the law: those that shape it as they are, its size only as a scale.
    powers : tuple of Power
        What its size is proportional to: its sum over these is the size.
    substeps : int
        Steps of its states between two samples.
    """

    kind: str
    law: type[PlantLaw] | None = None
    guess: Guess | None = None
    powers: tuple[Power, ...] = (ALWAYS,)
    substeps: int = 1

    @property
    def free(self) -> tuple[str, ...]:
        """Parameters that shape the force: all but its size, and those that are a convention."""
        if self.law is None or self.guess is None:
            return ()
        size = self.guess.linear[:1]
        return tuple(name for name in self.law.parameters if name not in (*size, *self.guess.fixed))

    @property
    def called(self) -> str:
        """What it is called within a sentence."""
        return self.law.called() if self.law else self.kind

    @property
    def values(self) -> Mapping[str, float]:
        """Parameters of the law, its size as the scale."""
        return self.guess.values if self.guess else {}

    def at(self, values: Mapping[str, float]) -> Shape:
        """The same with other parameters that shape it."""
        assert self.guess is not None
        return replace(self, guess=replace(self.guess, values={**self.guess.values, **values}))

    def signal(self, test: ComponentTest) -> Floats:
        """Resisting force of the part at its scale, (s,) N."""
        if self.law is None:
            return {OFFSET: np.ones_like(test.x), SPRING: test.x, DAMPER: test.v}[self.kind]
        p = [self.values[name] for name in self.law.parameters]
        return -force_along(self.law, p, test.x, test.v, test.t, self.substeps)

    def stepped(self, test: ComponentTest) -> Shape:
        """The same with steps that are short enough for its parameters."""
        if self.law is None:
            return self
        p = [self.values[name] for name in self.law.parameters]
        return replace(self, substeps=substeps_for(self.law, p, test.x, test.v, test.t))


@dataclass(frozen=True)
class Signals:
    """What a law guesses its parameters from (`rthm_core.effects.guess.Signals`), here of a component."""

    x: Floats
    v: Floats
    a: Floats
    force: Floats
    time: Floats
    elongation: Floats = field(default_factory=lambda: np.empty(0))
    mass: float = 1.0
    stiffness: float = 0.0

    @property
    def frequency(self) -> float:
        """Where most of the motion is, rad/s."""
        return rms(self.v) / max(rms(self.x - self.x.mean()), 1e-300)

    @property
    def size(self) -> float:
        """Scale of the forces, N."""
        return max(rms(self.force - self.force.mean()), 1e-300)

    def ringing(self, lowest: float) -> Sequence[float]:
        """No wire, no ringing."""
        return ()


def signals_of(test: ComponentTest) -> Signals:
    """Motion and force of a component as a law sees them."""
    return Signals(test.x, test.v, np.gradient(test.v, test.step), test.force, test.t)


def seen_in(test: ComponentTest) -> Seen:
    """What a recording shows of a law that acts here."""
    low, high = float(test.x.min()), float(test.x.max())
    speed = float(np.abs(test.v).max())
    return Seen(test.step, float(test.t[-1]), lowest=low, highest=high, speed=speed)


def base_shapes(powers: tuple[Power, ...]) -> list[Shape]:
    """Offset, spring and damper, each scaled by these powers."""
    return [Shape(kind, powers=powers) for kind in UNITS]


def law_shapes(test: ComponentTest, powers: tuple[Power, ...]) -> Iterator[Shape]:
    """Every beginning of every law that may act in a component whose motion is known.

    Not those with a mass, which motion in and force out do not show apart from a spring; nor those that act
    without any motion, or are written by a user.
    """
    signals = signals_of(test)
    for law in ranked("plant"):
        has_mass = any(getattr(one, "unit", "") == "kg" for one in law.parameters.values())
        if has_mass or law.additive or law.written or law.is_tone or reads_load(law):
            continue
        for guess in law.guesses(signals):
            if guess.linear:
                yield Shape(law.kind, law, guess, powers)  # type: ignore[arg-type]
