"""Whether spec and recording are of the same test at all: asked once signs, units and swaps were tried."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    OSCILLATION_FEWEST_PERIODS,
    OSCILLATION_POWER_SHARE,
    OTHER_FREQUENCY_FACTOR_DOWN,
    OTHER_FREQUENCY_FACTOR_UP,
    OTHER_LINEAR_CORRELATION,
    OTHER_MASS_FACTOR,
    OTHER_PERIOD_LOG,
    OTHER_START_SHARE,
    OTHER_WIRE_FACTOR,
    OTHER_WIRE_LEAST_WEIGHT,
    OTHER_WIRE_PARTS,
)
from rthm_analysis.diagnosis.faults.plant import plant_seen
from rthm_analysis.diagnosis.faults.relations import Wire, related, wire_signals, wires_of
from rthm_analysis.diagnosis.faults.smooth import Smooth, channel_at, smoothed
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.diagnosis.signals import filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def find_wrong_spec(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Tell a spec that cannot be that of the recording, with what shows it; nothing is corrected."""
    assert spec.plant is not None
    names = spec.actuator.names if spec.actuator and evidence.driven_by == "command" else ()
    smooth = smoothed(evidence, spec.plant.dofs, names)
    reasons = [_period(evidence, spec), _start(evidence, spec)]
    if smooth is not None:
        reasons += [_wire(smooth, wire) for wire in wires_of(spec)]
        reasons += [_plant(smooth, spec), _free(evidence, spec)]
    known = [one for one in reasons if one]
    if not known:
        return evidence, []
    words = (
        f"The spec is not that of this recording: {'; '.join(text for _, text, _ in known)}. Other signs, "
        "units and swapped channels do not explain it. Give the spec of this test with --spec."
    )
    channel, _, value = known[0]
    return evidence, [Fault("plant", "wrong_spec", channel, words, None, value)]


Reason = tuple[str, str, float] | None
"""Entry of the spec, words, and the value that the recording has."""


def _period(evidence: Evidence, spec: Spec) -> Reason:
    """Sampling period of the plant's state."""
    if evidence.driven_by != "command" or spec.timing is None:
        return None
    seen, known = float(np.median(np.diff(evidence.time))), spec.timing.td1
    if abs(np.log(max(seen, 1e-12) / known)) < OTHER_PERIOD_LOG:
        return None
    return (
        "timing.td1",
        f"the plant was sampled every {1e3 * seen:.4g} ms, the spec says {1e3 * known:.4g} ms",
        seen,
    )


def _start(evidence: Evidence, spec: Spec) -> Reason:
    """First sample of a loop, which begins where the spec says."""
    if evidence.driven_by != "command":
        return None
    for dof, nominal in zip(spec.plant.dofs, spec.plant.initial_position, strict=True):
        column = channel_at(evidence, "position", dof)
        if column is None:
            continue
        values = evidence.measured[:, column]
        first = values[:3][np.isfinite(values[:3])]
        if not first.size or not np.nanmax(values) > np.nanmin(values):
            continue
        reach = max(float(np.nanmax(values) - np.nanmin(values)), abs(nominal))
        if abs(float(first.mean()) - nominal) > OTHER_START_SHARE * reach > 0.0:
            text = f"{dof} begins at {first.mean():.3g} m, the spec says {nominal:.3g} m"
            return "plant.initial_position", text, float(first.mean())
    return None


def _wire(smooth: Smooth, wire: Wire) -> Reason:
    """Stiffness of a wire in many parts of the recording: that of the spec is seen nowhere."""
    names = wire_signals(smooth, wire)
    if names is None:
        return None
    force, motor, position = (smooth.values[name] for name in names)
    longer = motor - position
    stiffness, weight = _local(longer, force)
    if stiffness.size < OTHER_WIRE_PARTS // 2:
        return None
    allowed = OTHER_WIRE_FACTOR * (1.0 + 2.0 * wire.uncertainty)
    strong = stiffness[weight > OTHER_WIRE_LEAST_WEIGHT * weight.max()]
    if np.any((strong > wire.stiffness / allowed) & (strong < wire.stiffness * allowed)):
        return None
    if related(longer, force)[1] < OTHER_LINEAR_CORRELATION:
        return None
    value = float(np.median(strong))
    text = f"force and elongation show a wire of {value:.3g} N/m, the spec says {wire.stiffness:.3g} N/m"
    return "actuator.stiffness", text, value


def _local(longer: Floats, force: Floats) -> tuple[Floats, Floats]:
    """Stiffness in each part, and how much the elongation changes there."""
    found, weight = [], []
    for part in np.array_split(np.arange(longer.size), OTHER_WIRE_PARTS):
        d, f = longer[part] - longer[part].mean(), force[part] - force[part].mean()
        size = float(d @ d)
        if size > 0.0:
            found.append(float(d @ f) / size)
            weight.append(size)
    return np.array(found), np.array(weight)


def _plant(smooth: Smooth, spec: Spec) -> Reason:
    """Mass and natural frequency under known forces."""
    seen = plant_seen(smooth, spec)
    if seen is None or seen.correlation < OTHER_LINEAR_CORRELATION or any(one <= 0.0 for one in seen.told):
        return None
    unsure = spec.uncertainty.plant
    if seen.frequency is not None:
        wide = 1.0 + unsure.mass + unsure.stiffness
        least, most = 1.0 / (OTHER_FREQUENCY_FACTOR_DOWN * wide), OTHER_FREQUENCY_FACTOR_UP * wide
        if seen.frequency > most or seen.frequency < least:
            text = f"the plant's natural frequency is {seen.frequency:.3g} times that of the spec"
            return "plant.stiffness", text, seen.frequency
    if seen.mass is not None:
        wide = OTHER_MASS_FACTOR * (1.0 + 2.0 * unsure.mass)
        if not 1.0 / wide < seen.mass < wide:
            mass = seen.mass * spec.plant.mass[0]
            return "plant.mass", f"the motion needs a mass of {mass:.3g} kg", mass
    return None


def _free(evidence: Evidence, spec: Spec) -> Reason:
    """Frequency of a free oscillation of a plant of one dof."""
    assert spec.plant is not None
    column = channel_at(evidence, "position", spec.plant.dofs[0])
    alone = evidence.driven_by == "force" and len(spec.plant.dofs) == 1 and not evidence.load.any()
    if not alone or column is None or spec.plant.stiffness[0] <= 0.0:
        return None
    values, duration = filled(evidence.measured[:, column]), float(evidence.time[-1])
    power = np.square(np.abs(np.fft.rfft((values - values.mean()) * np.hanning(values.size))))
    power[:2] = 0.0
    peak = int(np.argmax(power))
    near = power[max(peak - max(3, peak // 5), 0) : peak + max(3, peak // 5) + 1]
    if peak < OSCILLATION_FEWEST_PERIODS or near.sum() < OSCILLATION_POWER_SHARE * power.sum():
        return None
    seen = 2.0 * np.pi * peak / duration
    nominal = float(np.sqrt(spec.plant.stiffness[0] / spec.plant.mass[0]))
    wide = 1.0 + spec.uncertainty.plant.mass + spec.uncertainty.plant.stiffness
    if nominal / (OTHER_FREQUENCY_FACTOR_DOWN * wide) < seen < nominal * OTHER_FREQUENCY_FACTOR_UP * wide:
        return None
    text = f"the plant swings freely at {seen:.3g} rad/s, the spec's would at {nominal:.3g} rad/s"
    return "plant.stiffness", text, seen
