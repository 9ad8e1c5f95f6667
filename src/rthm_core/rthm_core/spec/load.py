"""Known external forces, w1 on the plant and w2 on the numerical substructure: one class per kind of load."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field

from rthm_core.spec.entries import Name, Number, Whole
from rthm_core.spec.sections import LONGEST_TIME, Section

Dof = Annotated[str, Name("dof at which the force acts, + along +x")]


class NoLoad(Section):
    """No external force."""

    dof: Dof
    kind: Literal["none"]


class ConstantLoad(Section):
    """Constant force."""

    dof: Dof
    kind: Literal["constant"]
    force: Annotated[float, Number("N", "the force")]


class HarmonicLoad(Section):
    """``A sin(w t + p)``, t from the start of the test."""

    dof: Dof
    kind: Literal["harmonic"]
    amplitude: Annotated[float, Number("N", "amplitude A")]
    frequency: Annotated[float, Number("rad/s", "angular frequency w", minimum=0.0)]
    phase: Annotated[float, Number("rad", "phase p")] = 0.0


class MultisineLoad(Section):
    """Sum of sinusoids of equal amplitude, evenly spaced from low to high, with random phases."""

    dof: Dof
    kind: Literal["multisine"]
    rms: Annotated[float, Number("N", "root mean square of the force", minimum=0.0)]
    low: Annotated[float, Number("rad/s", "lowest angular frequency", minimum=0.0)]
    high: Annotated[float, Number("rad/s", "highest angular frequency, not below the lowest", minimum=0.0)]
    count: Annotated[int, Whole("1", "number of sinusoids", minimum=1, maximum=100_000)]
    seed: Annotated[int, Whole("1", "number from which the phases follow")] = 0
    ramp: Annotated[
        float, Number("s", "time over which the force grows from zero", minimum=0.0, maximum=LONGEST_TIME)
    ] = 0.0


class FileLoad(Section):
    """Force from a table, with straight lines between its rows."""

    dof: Dof
    kind: Literal["file"]
    path: Annotated[str, Name("CSV file with the columns t (s) and force (N)")]


LoadSpec = Annotated[
    NoLoad | ConstantLoad | HarmonicLoad | MultisineLoad | FileLoad, Field(discriminator="kind")
]

LOAD_KINDS: dict[str, type[Section]] = {
    get_args(load.model_fields["kind"].annotation)[0]: load
    for load in (NoLoad, ConstantLoad, HarmonicLoad, MultisineLoad, FileLoad)
}
"""Class of each kind of load."""


class LoadsSpec(Section):
    """The loads on the two sides."""

    plant: LoadSpec | None = None
    numerical: LoadSpec | None = None
