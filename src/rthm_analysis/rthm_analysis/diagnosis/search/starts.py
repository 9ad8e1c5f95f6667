"""Where the search for each kind of effect begins: what the kind itself says (`Effect.guesses`).

A start names the parameters that a fit may move, and the one, `amplitude`, in which the effect is nearly
linear: its size is then estimated from one replay. Kinds that only act beyond a threshold have none: their
starts are tried as they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_core.effects.possible import ANYTHING, Seen

if TYPE_CHECKING:
    from rthm_core.effects import Effect


@dataclass(frozen=True)
class InitialGuess:
    """An initial guess of an effect.

    `also` is a second parameter in which it is linear by itself; `look_elsewhere` is the gain that the best
    of all places where it was looked for has by chance, beyond what every kind has to bring. `only_gain`: of
    the sensors of its dof one alone may have another gain; that of all would be a gain of the load.
    """

    added: EffectInstance
    free: tuple[str, ...]
    amplitude: tuple[str, ...]
    scales: dict[str, float] = field(default_factory=dict)
    signed: bool = False
    neutral: float = 0.0
    also: str | None = None
    look_elsewhere: float = 0.0
    only_gain: bool = False

    @property
    def label(self) -> tuple[str, str, str]:
        """Block, kind and place."""
        return self.added.block, self.added.kind, self.added.place

    @property
    def single(self) -> tuple[str, str] | None:
        """What there can only be one of, and where: dry friction at a place, maybe the gain of a sensor."""
        if self.added.law.jump:
            return "friction", self.added.place
        return ("gain", self.added.place) if self.only_gain else None

    def added_to(self, model: Model) -> Model:
        """A model with this effect, as large as it is here."""
        return model.plus(self.added, self.free, self.scales)

    def having(self, parameters: dict[str, float | str]) -> InitialGuess:
        """The same start with other values of its parameters."""
        return replace(self, added=replace(self.added, parameters=parameters))

    @property
    def doubled(self) -> InitialGuess:
        """The same start with twice the parameter `also`."""
        assert self.also is not None
        values = dict(self.added.parameters)
        values[self.also] = 2.0 * float(values[self.also])
        return self.having(values)

    def with_also(self, factor: float) -> InitialGuess:
        """The same start with the parameter `also` times a factor, which is kept positive."""
        assert self.also is not None
        values = dict(self.added.parameters)
        values[self.also] = max(factor, 0.05) * float(values[self.also])
        scales = self.scales | {self.also: float(values[self.also])}
        return replace(self.having(values), scales=scales)

    @property
    def trial(self) -> float:
        """Size of the first amplitude in the trial replay."""
        return abs(float(self.added.parameters[self.amplitude[0]]) - self.neutral)

    def sized(self, factor: float) -> InitialGuess:
        """The same start with its amplitude times a factor."""
        values = dict(self.added.parameters)
        for key in self.amplitude:
            values[key] = self.neutral + factor * (float(values[key]) - self.neutral)
        scales = {key: abs(float(values[key]) - self.neutral) or self.scales[key] for key in self.amplitude}
        return replace(self.having(values), scales=self.scales | scales)


def guessed(
    law: type[Effect], block: str, place: str, signals: Any, seen: Seen = ANYTHING
) -> Iterator[InitialGuess]:
    """Starts of a kind at a place, from what it says itself and what a recording shows there."""
    for guess in law.guesses(signals):
        values = {key: float(value) for key, value in guess.values.items()}
        neutral = dict.fromkeys(guess.linear[:1], guess.neutral)
        sizes = {key: abs(value - neutral.get(key, 0.0)) for key, value in values.items()}
        yield InitialGuess(
            EffectInstance(block, law.kind, place, dict(values), seen),
            tuple(key for key in values if key not in guess.fixed),
            guess.linear,
            {key: size for key, size in sizes.items() if size} | dict(guess.scales),
            guess.signed,
            guess.neutral,
            guess.linear[1] if guess.apart else None,
        )
