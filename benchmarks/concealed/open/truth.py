"""What is concealed in a case, and which answers state it rightly."""

from __future__ import annotations

from dataclasses import dataclass, field

from benchmarks.concealed.kinds import family

# Families of the words that the contract keeps for kinds to come.
_TO_COME = {
    "position_friction": "friction", "asymmetric_friction": "friction", "lugre": "friction",
    "power_drag": "drag", "cogging": "stiffness", "pole_spring": "stiffness",
    "saturating_spring": "stiffness", "sine_stiffness": "stiffness", "position_damping": "damping",
    "drifting_parameter": "varying", "stepping_parameter": "varying", "parametric_stiffness": "varying",
    "intermittent_contact": "contact",
}  # fmt: skip


def wide_family(block: str, kind: str) -> str:
    """Family of a kind, those to come included."""
    return _TO_COME.get(kind) or family(block, kind)


@dataclass(frozen=True)
class Hidden:
    """One concealed thing.

    Parameters
    ----------
    what
        In words.
    blocks
        Where it is; several where the recorded channels cannot tell them apart.
    families
        Families of kinds, or kinds, that state it, in these blocks.
    faults
        Kinds of entries in `faults` that state it; their blocks must be among `blocks`, but for faults of
        the spec.
    depends
        Variables on which a described force may depend: at least one of them must be among its own.
    retuned
        Spec entries that state it when they are retuned to it.
    parameters
        True values of a kind's or spec entry's parameters, in the rig's units.
    kind
        Of the library, where it is one.
    interval
        When it acts, in seconds of the simulation, where it does not all the time.
    several
        Whether some of the variables may be enough: forces with a memory, or of a mass; a motor's command
        and its position, which are the same but for its error.
    """

    what: str
    blocks: tuple[str, ...]
    families: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    depends: tuple[str, ...] = ()
    retuned: tuple[str, ...] = ()
    parameters: dict[str, float] = field(default_factory=dict)
    kind: str = ""
    interval: tuple[float, float] | None = None
    several: bool = False

    def stated_by_kind(self, block: str, kind: str) -> bool:
        """Whether a named kind states this."""
        of_it = kind == self.kind or kind in self.families or wide_family(block, kind) in self.families
        return block in self.blocks and of_it

    def stated_by_fault(self, block: str, kind: str) -> bool:
        """Whether a fault states this; what is wrong with a spec may be told anywhere."""
        return kind in self.faults and (block in self.blocks or kind.startswith("wrong_"))

    def stated_by_description(self, block: str, depends_on: list[str]) -> bool:
        """Whether a described force states this."""
        return block in self.blocks and bool(set(depends_on) & set(self.depends))
