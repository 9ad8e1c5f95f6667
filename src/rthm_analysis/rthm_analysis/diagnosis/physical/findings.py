"""From what was found in the physical side to a `Part` of the diagnosis."""

from __future__ import annotations

from functools import partial

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.physical.curves import force_curve
from rthm_analysis.diagnosis.physical.detection import detection_limits
from rthm_analysis.diagnosis.physical.judged import Simulated, coloured, held_out_squares, nrmse, simulate_all
from rthm_analysis.diagnosis.physical.rounding import rounded_section, rounded_sensors
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.wire_curves import wire_curve
from rthm_analysis.diagnosis.physical.work import law_work, wire_work
from rthm_analysis.diagnosis.replay.between import Between
from rthm_analysis.diagnosis.replay.evidence import Channel
from rthm_analysis.diagnosis.replay.model import PROPERTIES, Added, Model, nominal_values
from rthm_analysis.diagnosis.result import Alternative, Fit, Mismatch, Part, Physics, Retuned, Value
from rthm_analysis.diagnosis.search.judging import ENOUGH, PER_PARAMETER, Tried, distinguishable
from rthm_analysis.diagnosis.words import physics_words
from rthm_core.compiled import Floats
from rthm_core.effects import effect
from rthm_core.spec import apply

SLOW = 1.35
"""Power of the slow residual, over that of noise, above which something is left."""

REMAINS = 0.15
"""Part of the retuned model's mismatch that may remain for the difference to count as explained."""

SIGNAL_OF = {
    "plant": "position",
    "wire": "force",
    "motor": "motor",
    "sensor.position": "position",
    "sensor.velocity": "velocity",
    "sensor.force": "force",
}


def physical_part(physical: Physical) -> Part:
    """Everything that the physical side contributes to the diagnosis."""
    choice = physical.choice
    fitted = {"nominal": physical.nominal, "retuned": choice.base, "explained": choice.best}
    simulated = physical.fitting.cores.each_in_parts(partial(simulate_all, physical), fitted.values())
    runs = dict(zip(fitted, simulated, strict=True))
    rounded = rounded_sensors(physical, runs["explained"].predicted)
    physics = (*_drive_physics(physical), *_chosen_physics(physical, runs), *rounded)
    retuned = _retuned(physical)
    left = _left_over(physical, runs)
    located = {one.block for one in physics} | ({"plant"} if left else set())
    return Part(
        blocks=_mismatches(physical, runs, located),
        physics=physics,
        retuned=retuned,
        alternatives=_alternatives(physical),
        fits=_fits(physical, runs, located or ({"plant"} if retuned else set())),
        detection_limits=detection_limits(physical),
        curves=(
            *force_curve(physical, runs["explained"].predicted, physics),
            *wire_curve(physical, physics),
        ),
        changes=_changes(physical, retuned),
        effects=(*_effects(physical), *(rounded_section(one) for one in rounded)),
        unexplained=left,
        notes=(*physical.evidence.notes, *_on_the_load(physical)),
    )


def _on_the_load(physical: Physical) -> tuple[str, ...]:
    """What was found of the load between its samples, where the recording does not say it."""
    between = physical.experiment.between
    if between is Between.SMOOTH:
        return ()
    return (f"The load {between.value} between its samples: as a smooth curve it would explain less.",)


def _stds(fitted: Fitted) -> dict[str, float]:
    covariance = fitted.sums.covariance()
    return {
        p.key: float(np.sqrt(max(v, 0.0)))
        for p, v in zip(fitted.model.parameters, np.diag(covariance), strict=True)
    }


def _values(fitted: Fitted, index: int) -> dict[str, Value | str]:
    """Parameters of an added effect with their standard deviations."""
    stds, model = _stds(fitted), fitted.model
    one = model.added[index]
    declared = effect(one.kind, one.block)
    values: dict[str, Value | str] = {}
    for key, value in model.effect_values(index).items():
        if isinstance(value, str):
            values[key] = value
        else:
            std = stds.get(f"{model.name(index)}.{key}", 0.0)
            values[key] = Value(float(value), std, declared.unit(key, one.block))
    return values


def _chosen_physics(physical: Physical, runs: dict[str, Simulated]) -> list[Physics]:
    choice, found = physical.choice, []
    before = held_out_squares(physical, runs["retuned"].predicted)
    whole = max(before, 1e-300)
    for i, tried in enumerate(choice.rounds):
        after_fit = tried[0].fitted if i + 1 < len(choice.rounds) else choice.best
        after = held_out_squares(physical, simulate_all(physical, after_fit).predicted)
        one = choice.best.model.added[i]
        energy = _energy(physical, choice.best.model, i)
        values = _values(choice.best, i)
        share = (before - after) / whole
        words = physics_words(one.block, one.kind, one.place, values, share, energy)
        found.append(Physics(one.block, one.kind, one.place, values, words, energy, share))
        before = min(before, after)  # without its companion an effect may lead further away
    return found


def _energy(physical: Physical, model: Model, index: int) -> float:
    """Work of an added effect over the recording; a sensor does none itself."""
    spec, name = model.spec, model.name(index)
    one = next(e for e in spec.effects if e.name == name)
    if one.block.startswith("sensor"):
        return 0.0
    if one.block == "plant":
        return law_work(physical.experiment, physical.windows, spec, one)
    without = apply(spec, {"effects": [e.name for e in spec.effects if e.name != name]})
    return wire_work(physical.experiment, physical.windows, spec, without)


def _drive_physics(physical: Physical) -> list[Physics]:
    found = []
    for i, tried in enumerate(physical.drives):
        fitted = physical.drives[-1][0].fitted
        one = fitted.model.added[i]
        values = _values(fitted, i) | _settled_by_plant(physical, fitted.model.name(i), one)
        before = tried[-1].fitted.squares if len(tried) > 1 else float("nan")
        share = float(1.0 - tried[0].fitted.squares / before) if before > 0.0 else float("nan")
        energy = wire_work(physical.experiment, physical.windows, physical.settled, physical.spec)
        words = physics_words(one.block, one.kind, one.place, values, float("nan"), energy)
        found.append(Physics(one.block, one.kind, one.place, values, words, energy, max(share, 0.0)))
    return found


def _settled_by_plant(physical: Physical, name: str, one: Added) -> dict[str, Value | str]:
    """What the motion of the plant tells of an effect of a motor."""
    best = physical.choice.best
    stds, declared = _stds(best), effect(one.kind, one.block)
    told = (p for p in best.model.parameters if p.key.startswith(f"{name}."))
    keys = ((p.key.partition(".")[2], p) for p in told)
    return {key: Value(p.value, stds[p.key], declared.unit(key, one.block)) for key, p in keys}


def _retuned(physical: Physical) -> dict[str, Retuned]:
    """Uncertain parameters whose new values the recording asks for."""
    best = physical.choice.best
    tuned = [p for p in best.model.parameters if p.key in PROPERTIES]
    gain = physical.nominal.squares - physical.choice.base.squares
    if not tuned or gain < (ENOUGH + PER_PARAMETER * (len(tuned) - 1)) * physical.fitting.doubt:
        return {}
    stds, found = _stds(best), {}
    for p in tuned:
        values = nominal_values(physical.spec, p.key)
        for i, nominal in enumerate(values):
            if nominal:
                name = p.key if len(values) == 1 else f"{p.key}[{i}]"
                found[name] = Retuned(nominal, nominal * p.value, abs(nominal) * stds[p.key])
    return found


def _left_over(physical: Physical, runs: dict[str, Simulated]) -> tuple[str, ...]:
    """Where a significant mismatch is left after everything; empty when little is."""
    train = slice(0, physical.train)
    said = []
    for k, channel in enumerate(physical.evidence.channels):
        residual = (physical.evidence.measured - runs["explained"].predicted)[train, k] / physical.sigma[k]
        first = (physical.evidence.measured - runs["retuned"].predicted)[train, k] / physical.sigma[k]
        left, before = coloured(residual), coloured(first)
        remains = (left - 1.0) / max(before - 1.0, 1e-9)
        if left > SLOW and (remains > REMAINS or not physical.choice.rounds):
            size = np.sqrt(np.nanmean(np.square(residual)))
            said.append(
                f"{channel.signal}: the error is {size:.3g} times the noise "
                f"and not random; {100.0 * min(remains, 1.0):.3g} % of the mismatch is left."
            )
    return tuple(said)


def _channel(physical: Physical, block: str) -> int | None:
    family = SIGNAL_OF[block]
    found = [i for i, c in enumerate(physical.evidence.channels) if c.family == family]
    return found[0] if found else None


def _mismatches(physical: Physical, runs: dict[str, Simulated], located: set[str]) -> tuple[Mismatch, ...]:
    """One-block prediction errors over their noise."""
    measured, settled = physical.evidence.measured, runs["nominal"].predicted
    residual = measured - settled
    found = []
    channels: tuple[Channel, ...] = physical.evidence.channels
    for block in ("plant", "wire", "sensor.position", "sensor.velocity", "sensor.force"):
        k = _channel(physical, block)
        if k is None:
            continue
        if block == "wire":
            error = _wire_error(physical, residual, k)
        elif block == "plant":
            error = residual[:, k] / physical.sigma[k]
        else:
            error = ((measured - runs["explained"].predicted)[:, k]) / physical.sigma[k]
            if block in located:
                error = residual[:, k] / physical.sigma[k]
        found.append(Mismatch(block, _rms(error), block in located))
    if physical.drives:
        first = physical.drives[0]
        count = max(first[0].fitted.residual.size, 1)
        found.append(Mismatch("motor", float(np.sqrt(first[-1].fitted.squares / count)), True))
    elif physical.evidence.driven_by == "command":
        found.append(Mismatch("motor", 1.0, False))
    assert channels
    return tuple(found)


def _wire_error(physical: Physical, residual: Floats, k: int) -> Floats:
    """Error of the force alone: what the error of the position it pulls at explains is taken out."""
    spec, channels = physical.settled, physical.evidence.channels
    assert spec.actuator is not None and spec.interface is not None
    actuator = spec.actuator.names.index(channels[k].place)
    stiffness, dof = spec.k_tot[actuator], spec.interface.plant_dof[actuator]
    for i, channel in enumerate(channels):
        if channel.family == "position" and channel.place == dof:
            noise = np.hypot(physical.sigma[k], stiffness * physical.sigma[i])
            return np.asarray((residual[:, k] + stiffness * residual[:, i]) / noise)
    return residual[:, k] / physical.sigma[k]


def _rms(error: Floats) -> float:
    return float(np.sqrt(np.nanmean(np.square(error))))


def _alternatives(physical: Physical) -> tuple[Alternative, ...]:
    """Other kinds that were tried, nearest first."""
    found: list[Alternative] = []
    for tried in physical.drives:
        for other in tried[1:4]:
            apart = distinguishable(tried[0].fitted, other.fitted)
            found.append(Alternative("motor", other.label[1], float("nan"), apart))
    choice = physical.choice
    others = [other for tried in choice.rounds for other in tried[1:5]]

    def alternative(other: Tried) -> Alternative:
        k = _channel(physical, other.label[0]) or 0
        error = nrmse(physical, simulate_all(physical, other.fitted).predicted, k)
        return Alternative(other.label[0], other.label[1], error, distinguishable(choice.best, other.fitted))

    return (*found, *physical.fitting.cores.each_in_parts(alternative, others))


def _fits(physical: Physical, runs: dict[str, Simulated], blocks: set[str]) -> tuple[Fit, ...]:
    fits = []
    time, train = physical.evidence.time, physical.train
    for block in sorted(blocks):
        k = _channel(physical, block)
        if k is None:
            continue
        held = slice(train, None)
        errors = {name: nrmse(physical, run.predicted, k) for name, run in runs.items()}
        spread = float(np.nanstd(physical.evidence.measured[held, k])) or 1.0
        errors["noise_floor"] = float(physical.sigma[k]) / spread
        fits.append(
            Fit(
                block,
                physical.evidence.channels[k].signal,
                physical.windows.length,
                (0.0, float(time[train])),
                (float(time[train]), float(time[-1])),
                errors,
                time[held],
                physical.evidence.measured[held, k],
                runs["nominal"].predicted[held, k],
                runs["retuned"].predicted[held, k],
                runs["explained"].predicted[held, k],
            )
        )
    return tuple(fits)


def _changes(physical: Physical, retuned: dict[str, Retuned]) -> dict[str, float]:
    return {name: one.value for name, one in retuned.items()}


def _effects(physical: Physical) -> tuple[dict[str, object], ...]:
    """Sections for the patched spec."""
    sections = []
    if physical.drives:
        model = physical.drives[-1][0].fitted.model
        for i, one in enumerate(model.added):
            told = _settled_by_plant(physical, model.name(i), one).items()
            known = {key: value.value for key, value in told if isinstance(value, Value)}
            sections.append(one.section(model.effect_values(i) | known))
    model = physical.choice.best.model
    sections += [one.section(model.effect_values(i)) for i, one in enumerate(model.added)]
    return tuple(sections)
