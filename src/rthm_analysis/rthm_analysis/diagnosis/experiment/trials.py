"""A trial: an input that a planned test could have, and what it makes of the nominal spec."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rthm_core.spec import ConstantLoad, HarmonicLoad, MultisineLoad, apply

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import LoadSpec, Spec

SIDES = ("plant", "numerical")


@dataclass(frozen=True)
class Trial:
    """Loads and initial motion of a test.

    Attributes
    ----------
    loads : dict
        Section ``load.plant`` and ``load.numerical`` by side; a side without one has no load.
    start : float
        Initial positions and velocities over those of the nominal spec; 0: at rest at zero.
    recorded : (Floats, Floats) or None
        Instants (s,), s, and forces (s, n), N, of a load on the plant that the recording knows sample by
        sample.
    """

    loads: dict[str, LoadSpec]
    start: float = 0.0
    recorded: tuple[Floats, Floats] | None = None

    def changed(self, nominal: Spec) -> Spec:
        """The nominal spec with this input."""
        changes: dict[str, Any] = {}
        for side in SIDES:
            old, new = getattr(nominal.load, side), self.loads.get(side)
            if new is not None:
                changes |= {f"load.{side}.{key}": value for key, value in new.items()}
            elif old is not None:
                changes[f"load.{side}.kind"] = "none"
        for side in SIDES:
            section = getattr(nominal, side)
            for key in ("initial_position", "initial_velocity") if section is not None else ():
                changes[f"{side}.{key}"] = [self.start * one for one in getattr(section, key)]
        return apply(nominal, changes)

    def scaled(self, by: float) -> Trial:
        """The same with `by` times the load and the initial motion."""
        return Trial(
            {side: _scaled(one, by) for side, one in self.loads.items()},
            plain(self.start * by, 2),
            self.recorded,
        )


def harmonic(dof: str, amplitude: float, frequency: float) -> HarmonicLoad:
    """Load with numbers that one can say."""
    return HarmonicLoad(
        dof=dof, kind="harmonic", amplitude=plain(amplitude, 2), frequency=plain(frequency, 3)
    )


def constant(dof: str, force: float) -> ConstantLoad:
    """Likewise."""
    return ConstantLoad(dof=dof, kind="constant", force=plain(force, 2))


def multisine(dof: str, rms: float, low: float, high: float, count: int) -> MultisineLoad:
    """Likewise."""
    return MultisineLoad(
        dof=dof, kind="multisine", rms=plain(rms, 2), low=plain(low, 2), high=plain(high, 2), count=count
    )


def plain(value: float, digits: int) -> float:
    """A number with few digits, so that what is computed is what is said."""
    return float(f"{value:.{digits}g}")


def size_of(section: LoadSpec) -> float:
    """Amplitude, rms or force of a load, N."""
    return float(next(getattr(section, key) for key in SIZES if hasattr(section, key)))


SIZES = ("amplitude", "rms", "force")


def _scaled(section: LoadSpec, by: float) -> LoadSpec:
    for key in SIZES:
        if hasattr(section, key):
            return section.model_copy(update={key: plain(by * getattr(section, key), 2)})
    return section
