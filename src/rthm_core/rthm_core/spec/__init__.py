"""The spec: one ROS 2 parameter file that describes a test for every part of the system."""

from rthm_core.spec.amplitude import scaled_motion
from rthm_core.spec.building import spec_from_parameters
from rthm_core.spec.changes import apply, number_at, with_effects_from, with_timing
from rthm_core.spec.numbers import numbers
from rthm_core.spec.parameters import Parameter, parameters
from rthm_core.spec.reading import (
    read_spec,
    shipped_names,
    shipped_spec,
    shipped_text,
    spec_at,
    spec_with_own_effects,
)
from rthm_core.spec.schema import (
    ActuatorSpec,
    ConstantLoad,
    EffectSpec,
    FileLoad,
    HarmonicLoad,
    InterfaceSpec,
    LimitsSpec,
    LoadSpec,
    LoadsSpec,
    Loop,
    MultisineLoad,
    NoiseSpec,
    NoLoad,
    Spec,
    SubstructureSpec,
    TimingSpec,
    TransmissionSpec,
    UncertaintySpec,
    ZeroSpec,
)
from rthm_core.spec.writing import write_spec
from rthm_core.spec.yaml_text import NODE_PARAMETERS

__all__ = [
    "NODE_PARAMETERS",
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
    "Parameter",
    "Spec",
    "SubstructureSpec",
    "TimingSpec",
    "TransmissionSpec",
    "UncertaintySpec",
    "ZeroSpec",
    "apply",
    "number_at",
    "numbers",
    "parameters",
    "read_spec",
    "scaled_motion",
    "shipped_names",
    "shipped_spec",
    "shipped_text",
    "spec_at",
    "spec_from_parameters",
    "spec_with_own_effects",
    "with_effects_from",
    "with_timing",
    "write_spec",
]
