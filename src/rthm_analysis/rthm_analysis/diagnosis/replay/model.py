"""A model of the physical side: the nominal spec, retuned parameters, added effects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.diagnosis.replay.entries import (
    MAY_DRIVE,
    OF_PLANT,
    WIRE,
    entry_of,
    nominal_values,
    uncertain_entries,
    with_entry,
)
from rthm_core.effects import Effect, effect
from rthm_core.effects.possible import ANYTHING, Seen
from rthm_core.errors import RefusedError
from rthm_core.quantity import Text
from rthm_core.spec import apply
from rthm_core.spec.effect import placed
from rthm_core.spec.sections import MATRICES

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

PROPERTIES = OF_PLANT | {WIRE: MATRICES["stiffness"]}
"""Properties that a spec can call uncertain, and their units."""


@dataclass(frozen=True)
class Parameter:
    """A number of the model that may move.

    Attributes
    ----------
    key : str
        ``plant.mass`` (a factor on the nominal value) or ``<effect>.<parameter>``, of an added effect or of
        one that the nominal spec has.
    value, scale : float
        Present value, and its typical size.
    low, high : float
        Bounds.
    prior : (float, float) or None
        Mean and standard deviation that the spec states.
    along : int or None
        Place among the parameters of a positive one in whose proportion it moves.
    """

    key: str
    value: float
    scale: float
    low: float = -np.inf
    high: float = np.inf
    prior: tuple[float, float] | None = None
    along: int | None = None

    @property
    def positive(self) -> bool:
        """Whether it is a size that cannot vanish: it then moves by factors."""
        return self.low >= 0.0 and self.value > 0.0 and self.prior is None

    @property
    def at_bound(self) -> bool:
        """Whether it would go further if that were possible."""
        return abs(self.value - self.nearest) <= 1e-6 * abs(self.value)

    @property
    def nearest(self) -> float:
        """The bound that it is nearest to."""
        return self.low if self.value - self.low < self.high - self.value else self.high

    def at(self, value: float) -> Parameter:
        """The same parameter with another value, kept within its bounds."""
        return replace(self, value=float(min(max(value, self.low), self.high)))

    def within(self, low: float, high: float) -> Parameter:
        """The same parameter kept within other bounds."""
        return replace(self, low=low, high=high).at(self.value)


@dataclass(frozen=True)
class EffectInstance:
    """An effect that the nominal spec does not have, and what the recording shows of its place."""

    block: str
    kind: str
    place: str
    parameters: dict[str, float | str]
    seen: Seen = ANYTHING

    @property
    def law(self) -> type[Effect]:
        """Its kind."""
        return effect(self.kind, self.block).given(self.parameters)

    def bounds(self, key: str, values: dict[str, float | str]) -> tuple[float, float]:
        """Values that a spec allows and that are possible, given those of the other parameters."""
        quantity = self.law.parameters[key]
        assert not isinstance(quantity, Text)
        low = -np.inf if quantity.minimum is None else quantity.minimum
        low = low if quantity.above is None else quantity.above + 1e-12
        high = np.inf if quantity.maximum is None else quantity.maximum
        if key in self.law.possible:
            others = {name: value for name, value in values.items() if not isinstance(value, str)}
            least, most = self.law.possible[key](others, self.seen)
            low, high = max(low, least), min(high, most)
        return low, max(low, high)

    def check(self, keys: Iterable[str]) -> None:
        """Raise InputError where a spec does not allow the value of one of these parameters."""
        for key in keys:
            try:
                self.law.parameters[key].convert(self.parameters[key])
            except RefusedError as error:
                raise error.at(f"{self.kind}.{key}") from None

    @property
    def texts(self) -> tuple[str, ...]:
        """Its parameters that are text."""
        return tuple(value for value in self.parameters.values() if isinstance(value, str))

    @property
    def label(self) -> tuple[str, str]:
        """Block and kind."""
        return self.block, self.kind

    def section(self, parameters: dict[str, float | str]) -> dict[str, Any]:
        """Section of a spec."""
        return {"block": self.block, "kind": self.kind, **placed(self.block, self.place), **parameters}


@dataclass(frozen=True)
class Model:
    """Nominal spec, factors on uncertain properties, added effects.

    `checked` keeps the spec of each set of added effects, once it was checked, for models with other values.
    Models that were made of one another share it.
    """

    nominal: Spec
    parameters: tuple[Parameter, ...] = ()
    added: tuple[EffectInstance, ...] = ()
    prefix: str = "found"
    checked: dict[tuple[Any, ...], Spec] = field(default_factory=dict, compare=False, repr=False)

    @property
    def values(self) -> Floats:
        """Values of the parameters."""
        return np.array([p.value for p in self.parameters])

    def at(self, values: Floats) -> Model:
        """The model with other values of its parameters."""
        moved = [replace(p, value=float(v)) for p, v in zip(self.parameters, values, strict=True)]
        return replace(self, parameters=self._possible(moved))

    def _possible(self, moved: list[Parameter]) -> tuple[Parameter, ...]:
        """Parameters kept to what is possible, each given the others, and itself as it was before."""
        places = {p.key: i for i, p in enumerate(moved)}
        found = [p.at(p.value) for p in moved]
        for index, one in enumerate(self.added):
            free = {key: places[name] for key in one.parameters if (name := self._key(index, key)) in places}
            values = one.parameters | {key: found[i].value for key, i in free.items()}
            for key in (key for key in one.law.possible if key in free):
                i = free[key]
                bounds = one.bounds(key, values | {key: self.parameters[i].value})
                found[i] = moved[i].within(*bounds)
                values[key] = found[i].value
        return tuple(found)

    @property
    def unlikeliness(self) -> float:
        """Sum of the squared distances of its values from what the spec states, in standard deviations."""
        return float(sum(((p.value - p.prior[0]) / p.prior[1]) ** 2 for p in self.parameters if p.prior))

    @property
    def as_stated(self) -> Model:
        """The same with the values that the spec states, where it states any."""
        return self.at(np.array([p.prior[0] if p.prior else p.value for p in self.parameters]))

    def places(self, index: int) -> dict[str, int]:
        """Places among the parameters of those of an added effect that may move."""
        name = f"{self.name(index)}."
        found = ((p.key, i) for i, p in enumerate(self.parameters))
        return {key.removeprefix(name): i for key, i in found if key.startswith(name)}

    def _key(self, index: int, key: str) -> str:
        """Name of a parameter of an added effect."""
        return f"{self.name(index)}.{key}"

    def plus(self, one: EffectInstance, free: tuple[str, ...], scales: dict[str, float]) -> Model:
        """The model with one more effect, of whose parameters those in `free` may move."""
        one.check(key for key in one.parameters if key not in free)
        new = []
        for key in free:
            low, high = one.bounds(key, one.parameters)
            value = float(one.parameters[key])
            along = one.law.along.get(key)
            place = len(self.parameters) + free.index(along) if along in free else None
            scale = scales.get(key, abs(value) or 1.0)
            new.append(Parameter(self._key(len(self.added), key), value, scale, low, high, along=place))
        more = replace(self, parameters=(*self.parameters, *new), added=(*self.added, one))
        return more.at(more.values)

    def name(self, index: int) -> str:
        """Name of the section of an added effect, behind those of the same prefix that the spec has."""
        return f"{self.prefix}{index + 1 + self._numbered}"

    @cached_property
    def _numbered(self) -> int:
        """Highest number behind the prefix among the effects of the spec: one that was patched has some."""
        names = (one.name for one in self.nominal.effects if one.name.startswith(self.prefix))
        ends = (name.removeprefix(self.prefix) for name in names)
        return max((int(end) for end in ends if end.isdecimal()), default=0)

    def effect_values(self, index: int) -> dict[str, float | str]:
        """Parameters of an added effect with their present values."""
        values = dict(self.added[index].parameters)
        for p in self.parameters:
            name, _, key = p.key.partition(".")
            if name == self.name(index):
                values[key] = p.value
        return values

    @property
    def spec(self) -> Spec:
        """Spec of this model; checked once, as its parameters keep to their bounds."""
        key = tuple((one.block, one.kind, one.place, one.texts, *one.parameters) for one in self.added)
        if key not in self.checked:
            self.checked[key] = self._checked()
        return self._with_values(self.checked[key])

    def _checked(self) -> Spec:
        names = [self.name(i) for i in range(len(self.added))]
        changes: dict[str, Any] = {"effects": [*(e.name for e in self.nominal.effects), *names]}
        for i, (name, one) in enumerate(zip(names, self.added, strict=True)):
            changes[name] = one.section(self.effect_values(i))
        return apply(self.nominal, changes) if names else self.nominal

    def _with_values(self, spec: Spec) -> Spec:
        count = len(self.added)
        if count:
            known, added = spec.effects[:-count], spec.effects[-count:]
            valued = (
                one.model_copy(update={"parameters": one.parameters | self.effect_values(i)})
                for i, one in enumerate(added)
            )
            spec = spec.model_copy(update={"effects": (*known, *valued)})
        already = {e.name for e in self.nominal.effects}
        for p in self.parameters:
            if p.key in PROPERTIES and p.value != 1.0:
                spec = _scaled(spec, p.key, p.value)
            elif entry_of(p.key) is not None:
                spec = with_entry(spec, p.key, p.value)
            elif p.key.partition(".")[0] in already:
                spec = _valued(spec, p)
        return spec


def _valued(spec: Spec, parameter: Parameter) -> Spec:
    """Spec with another value in one of its effects."""
    name, _, key = parameter.key.partition(".")
    effects = (
        e.model_copy(update={"parameters": e.parameters | {key: parameter.value}}) if e.name == name else e
        for e in spec.effects
    )
    return spec.model_copy(update={"effects": tuple(effects)})


def _scaled(spec: Spec, key: str, factor: float) -> Spec:
    section, _, name = key.partition(".")
    values: dict[str, Any] = {name: tuple(factor * value for value in nominal_values(spec, key))}
    if section == "actuator":
        values["transmission"] = None
    return spec.model_copy(update={section: getattr(spec, section).model_copy(update=values)})


def uncertain(spec: Spec) -> tuple[Parameter, ...]:
    """What the spec calls uncertain: single values as factors, matrices and several wires entry by entry."""
    found: list[Parameter] = []
    for key in PROPERTIES:
        section, _, name = key.partition(".")
        relative = getattr(getattr(spec.uncertainty, section, None), name, 0.0) if spec.uncertainty else 0.0
        if not relative or getattr(spec, section) is None:
            continue
        if len(nominal_values(spec, key)) > 1:
            found += uncertain_entries(spec, key, float(relative))
        elif any(nominal_values(spec, key)):
            low = -np.inf if key in MAY_DRIVE else 1e-3
            found.append(Parameter(key, 1.0, float(relative), low, prior=(1.0, float(relative))))
    return (*found, *_uncertain_effects(spec))


def _uncertain_effects(spec: Spec) -> Iterator[Parameter]:
    """Parameters of effects that the spec has and calls uncertain."""
    for one in spec.effects:
        instance = EffectInstance(one.block, one.kind, one.place, one.parameters)
        for name, relative in one.uncertainty.items():
            value = one.numbers[name]
            if relative and value:
                low, high = instance.bounds(name, one.parameters)
                spread = relative * abs(value)
                yield Parameter(f"{one.name}.{name}", value, spread, low, high, prior=(value, spread))
