"""Noise that is much louder than the spec says: what hides in it is not looked for."""

from __future__ import annotations

from collections.abc import Iterator

from rthm_analysis.diagnosis.criteria.readings import LOUD_RATIO
from rthm_analysis.diagnosis.faults.naming import in_words
from rthm_analysis.diagnosis.numbers import bare, with_unit
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF


def loud(physical: Physical) -> Iterator[str]:
    """One sentence for each signal whose noise is several times what the spec states; none where it states
    nothing.
    """
    stated = physical.spec.noise
    for channel, level in zip(physical.evidence.channels, physical.noise.level, strict=True):
        said = float(getattr(stated, channel.family, 0.0))
        if said and level > LOUD_RATIO * said:
            unit = UNIT_OF[channel.family]
            yield (
                f"The noise of {in_words(channel)} is {bare(level / said, 2)} times what the spec says, "
                f"{with_unit(float(level), unit)} instead of {with_unit(said, unit)}: what is no larger and "
                "as fast is taken as noise. Look for its cause, or state it."
            )
