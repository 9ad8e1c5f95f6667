"""What was found, in words for a test engineer."""

from __future__ import annotations

import math

from rthm_analysis.diagnosis.result import Physics, Retuned, Value
from rthm_core.effects import effect

UNITS = {"plant.mass": "kg", "plant.damping": "N s/m", "plant.stiffness": "N/m", "actuator.stiffness": "N/m"}

BLOCK_WORDS = {
    "plant": "the physical substructure",
    "wire": "the wire",
    "motor": "the motor",
    "numerical": "the numerical substructure",
    "controller": "the controller",
    "sensor.position": "the position sensor",
    "sensor.velocity": "the velocity sensor",
    "sensor.force": "the force sensor",
}

ADVICE = {
    ("motor", "extra_delay"): " Compare timing.tau4 in the spec with the delays that the drive and its node "
    "were set to."
}
"""What to look at where software rather than the rig may be the reason."""


def block_words(block: str) -> str:
    """A block's name in a sentence."""
    return f"the link {block.removeprefix('link.')}" if block.startswith("link.") else BLOCK_WORDS[block]


def number(value: float, std: float, unit: str) -> str:
    """Value and uncertainty with the digits that mean something: ``0.118 +- 0.002 N``."""
    digits = 4 if not (math.isfinite(std) and std > 0.0) else _digits(value, std)
    suffix = "" if unit in ("", "1") else f" {unit}"
    if not (math.isfinite(std) and std > 0.0):
        return f"{value:.4g}{suffix}"
    return f"{value:.{digits}g} +- {std:.2g}{suffix}"


def _digits(value: float, std: float) -> int:
    if value == 0.0:
        return 2
    return min(max(2 + math.floor(math.log10(abs(value))) - math.floor(math.log10(std)), 2), 7)


def physics_words(
    block: str, kind: str, place: str, parameters: dict[str, Value | str], share: float, energy: float
) -> str:
    """What, where, how big, how sure, how much it explains, and what it costs."""
    declared = effect(kind, block)
    values = {key: v if isinstance(v, str) else v.value for key, v in parameters.items()}
    said = declared.describe(block, place, values)
    sure = ", ".join(
        f"{key.replace('_', ' ')} {number(v.value, v.std, v.unit)}"
        for key, v in parameters.items()
        if not isinstance(v, str)
    )
    text = f"{said[:1].upper()}{said[1:]} ({sure}; +- is one standard deviation)."
    text += ADVICE.get((block, kind), "")
    if math.isfinite(share) and share > 0.0:
        text += f" It removes {100.0 * share:.3g} % of the squared error on data that the fit has not seen."
    if math.isfinite(energy) and energy:
        way = "put in" if energy > 0.0 else "took out"
        text += f" Over the recording it {way} {abs(energy):.3g} J."
    return text


def retuned_words(retuned: dict[str, Retuned]) -> str:
    """New values of uncertain parameters in one sentence."""
    parts = []
    for name, one in retuned.items():
        unit = UNITS.get(name.partition("[")[0], "")
        change = 100.0 * (one.value / one.nominal - 1.0) if one.nominal else math.nan
        parts.append(
            f"{name} {number(one.value, one.std, unit)} instead of {one.nominal:.4g} ({change:+.1f} %)"
        )
    return "; ".join(parts)


def verdict_words(
    verdict: str, located: tuple[str, ...], physics: tuple[Physics, ...], retuned: dict[str, Retuned]
) -> str:
    """The answer in one or two sentences."""
    where = " and ".join(block_words(block) for block in located)
    if verdict == "match":
        return (
            "Simulation and recording agree to within the noise: "
            "nothing is missing that this recording could show."
        )
    if verdict == "retuned":
        return (
            "No physics is missing; uncertain parameters have other values than assumed: "
            f"{retuned_words(retuned)}."
        )
    named = " ".join(one.words for one in physics)
    if verdict == "explained":
        tuned = f" Besides, {retuned_words(retuned)}." if retuned else ""
        return f"Simulation and recording differ in {where}. {named}{tuned}"
    found = f" What is known of it: {named}" if physics else ""
    return f"Simulation and recording differ in {where}, and no known kind of physics explains it.{found}"
