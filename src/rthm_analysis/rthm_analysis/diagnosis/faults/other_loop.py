"""Whether delays, periods and computing blocks are those of another loop than the spec's."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rthm_analysis.diagnosis.criteria.signals import OTHER_LOOP_ENTRIES
from rthm_analysis.diagnosis.result import Fault, Part
from rthm_core.effects import effect

COMPUTED = {"controller": "the controller", "numerical": "the numerical substructure"}


def find_other_loop(parts: Iterable[Part]) -> list[Fault]:
    """Tell a spec of which hardly anything agrees with what the loop did; none where it may be the right one.

    Parameters
    ----------
    parts : iterable of Part
        What was found of links and computing blocks.
    """
    unlike = dict.fromkeys(one for part in parts for one in _unlike(part))
    if len(unlike) < OTHER_LOOP_ENTRIES or not unlike.keys() & set(COMPUTED.values()):
        return []
    *names, last = unlike
    words = (
        f"The spec is not that of this recording: {', '.join(names)} and {last} are others than it says. "
        "Give the spec of this test with --spec."
    )
    return [Fault("plant", "wrong_spec", next(iter(unlike)), words)]


def _unlike(part: Part) -> Iterator[str]:
    """What does not agree with the spec: its timing by name, and blocks that compute something else."""
    yield from (one.channel for one in part.faults if one.channel.startswith("timing."))
    links = (one for one in part.physics if one.block.startswith("link."))
    late = [one.block for one in links if effect(one.kind, one.block).changes == "delay"]
    yield from (block.replace("link.", "timing.") for block in late)
    yield from (COMPUTED[one.block] for one in part.blocks if one.significant and one.block in COMPUTED)
