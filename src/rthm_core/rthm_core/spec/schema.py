"""The spec: one description of a hybrid test for every part of the system."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple, Self

from pydantic import model_validator

from rthm_core.errors import InputError
from rthm_core.spec.checks import check
from rthm_core.spec.effect import EffectSpec
from rthm_core.spec.entries import Names
from rthm_core.spec.load import (
    ConstantLoad,
    FileLoad,
    HarmonicLoad,
    LoadSpec,
    LoadsSpec,
    MultisineLoad,
    NoLoad,
)
from rthm_core.spec.sections import (
    ActuatorSpec,
    InterfaceSpec,
    LimitsSpec,
    NoiseSpec,
    Section,
    SubstructureSpec,
    TimingSpec,
    TransmissionSpec,
    UncertaintySpec,
    ZeroSpec,
)

__all__ = [
    "ActuatorSpec",
    "ConstantLoad",
    "EffectSpec",
    "FileLoad",
    "HarmonicLoad",
    "InterfaceSpec",
    "LimitsSpec",
    "LoadSpec",
    "LoadsSpec",
    "Loop",
    "MultisineLoad",
    "NoLoad",
    "NoiseSpec",
    "Spec",
    "SubstructureSpec",
    "TimingSpec",
    "TransmissionSpec",
    "UncertaintySpec",
    "ZeroSpec",
]


class Loop(NamedTuple):
    """The sections of a complete hybrid test."""

    plant: SubstructureSpec
    numerical: SubstructureSpec
    interface: InterfaceSpec
    actuator: ActuatorSpec
    timing: TimingSpec


class Spec(Section):
    """A hybrid test, or a plant alone (contract, section 2). Immutable; `apply` gives a changed one."""

    plant: SubstructureSpec
    numerical: SubstructureSpec | None = None
    interface: InterfaceSpec | None = None
    actuator: ActuatorSpec | None = None
    timing: TimingSpec | None = None
    load: LoadsSpec = LoadsSpec()
    noise: NoiseSpec = NoiseSpec()
    uncertainty: UncertaintySpec = UncertaintySpec()
    limits: LimitsSpec | None = None
    zero: ZeroSpec | None = None
    effects_from: Annotated[
        tuple[str, ...],
        Names("Python files, or modules, that declare kinds of effects; they are executed", longest=1000),
    ] = ()
    effects: tuple[EffectSpec, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        check(self)
        return self

    @property
    def is_loop(self) -> bool:
        """Whether this is a complete hybrid test; otherwise it is a plant alone."""
        return self.actuator is not None

    def loop(self) -> Loop:
        """Return the sections of the loop.

        Raises
        ------
        InputError
            If the spec describes a plant alone.
        """
        if not (self.numerical and self.interface and self.actuator and self.timing):
            raise InputError(
                "the spec describes a plant alone, but this needs a whole loop; "
                "add the sections numerical, interface, actuator and timing."
            )
        return Loop(self.plant, self.numerical, self.interface, self.actuator, self.timing)

    @property
    def k_tot(self) -> tuple[float, ...]:
        """Stiffness between motor and plant, in N/m, of every actuator; empty for a plant alone."""
        return self.actuator.k_tot if self.actuator else ()

    @property
    def hyperperiod_ns(self) -> int:
        """Time after which all clocks tick together again, in ns; InputError for a plant alone."""
        timing = self.loop().timing
        periods = [timing.ns(name) for name in ("td1", "td2", "td3", "td4")]
        return math.lcm(*(period for period in periods if period > 0))

    def expanded(self) -> str:
        """Return the spec as YAML text with every default written out."""
        from rthm_core.spec.writing import write_spec  # writing needs the schema

        return write_spec(self)

    def scaled_timing(self, factor: float) -> Spec:
        """Return the spec with every period and every delay of the loop multiplied by `factor`."""
        from rthm_core.spec.changes import scaled_timing  # changes need the schema

        return scaled_timing(self, factor)
