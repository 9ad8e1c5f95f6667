"""From what was found in the physical side to a `Part` of the diagnosis."""

from __future__ import annotations

from collections.abc import Sequence

from rthm_analysis.diagnosis.criteria.verdict import (
    LATE_TRAINING_SHARE,
    RETUNED_LEFT_SHARE,
)
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.missing.describe import described, plainest, told
from rthm_analysis.diagnosis.physical.composing import compose_best
from rthm_analysis.diagnosis.physical.confirming import (
    because,
    confirmed,
)
from rthm_analysis.diagnosis.physical.curves import force_curve
from rthm_analysis.diagnosis.physical.detection import detection_limits
from rthm_analysis.diagnosis.physical.driven import drives_earned, motors_read_wrong, wires_are_off
from rthm_analysis.diagnosis.physical.fewer import judged_of, negligible, with_fewer
from rthm_analysis.diagnosis.physical.fewer_kinds import with_fewer_kinds
from rthm_analysis.diagnosis.physical.fewer_terms import with_fewer_terms
from rthm_analysis.diagnosis.physical.fits import channel_of, fits_of, free_runs, recording_fits
from rthm_analysis.diagnosis.physical.formulated import formulated
from rthm_analysis.diagnosis.physical.inseparable import all_alike, elsewhere, gains, inseparable
from rthm_analysis.diagnosis.physical.judged import nrmse, simulate_all
from rthm_analysis.diagnosis.physical.kinds_beside import each_by_itself, with_kinds
from rthm_analysis.diagnosis.physical.locating import when
from rthm_analysis.diagnosis.physical.loud import loud
from rthm_analysis.diagnosis.physical.mismatches import mismatches
from rthm_analysis.diagnosis.physical.motor_curves import motors_described
from rthm_analysis.diagnosis.physical.motor_formulated import motors_formulated
from rthm_analysis.diagnosis.physical.named_formula import with_names
from rthm_analysis.diagnosis.physical.offsets import offsets
from rthm_analysis.diagnosis.physical.parts_of_force import over_position, with_parts
from rthm_analysis.diagnosis.physical.plainer_terms import with_plainer_terms
from rthm_analysis.diagnosis.physical.push import LEFT_OUT
from rthm_analysis.diagnosis.physical.remainder import Remainder
from rthm_analysis.diagnosis.physical.rounding import rounded_section, rounded_sensors
from rthm_analysis.diagnosis.physical.shown_kinds import with_changed_mass, with_shown_kind
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.unconfirmed import unconfirmed
from rthm_analysis.diagnosis.physical.unforeseen import is_foretold, unforeseen
from rthm_analysis.diagnosis.physical.values import less_sure, retuned_values, settled_by_plant, values_of
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.wire_composing import compose_wires
from rthm_analysis.diagnosis.physical.wire_curves import wire_curve, wires_described
from rthm_analysis.diagnosis.physical.work import law_work, wire_work
from rthm_analysis.diagnosis.physical.zeros_told import zero_faults
from rthm_analysis.diagnosis.replay.between import Between
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.result import (
    Alternative,
    Described,
    Part,
    Physics,
    Refused,
    Retuned,
    Trace,
    Value,
)
from rthm_analysis.diagnosis.search.judging import FittedCandidate, distinguishable
from rthm_analysis.diagnosis.words import bare, physics_words
from rthm_core.spec import apply

STOOD_FOR = "beside the formula it is hardly needed, and a slightly other formula may do what it did"

ABOVE_NOISE = "it does little in the unseen data, and more than the noise is left beside it"

DRIVEN = (
    "The motors do not follow their commands as the spec says, and no known kind of physics explains it.",
)

READ_WRONG = (
    "The recorded positions of the motors are not what the commands make of them, and the wires' forces "
    "do not follow: the sensors of the motors are off.",
)

ABOVE_UNSEEN_NOISE = "On unseen data the error is larger than the noise."

LEFT_OF_FITTED = "Unseen data are predicted to the noise, but what is left of the fitted part is not random."

ONLY_UNSEEN = "It shows only in the last third, which chose nothing: unconfirmed."


def physical_part(physical: Physical, pushes: Sequence[Described] = ()) -> Part:
    """Everything that the physical side contributes to the diagnosis, behind `pushes` that were left out."""
    physical, refused = confirmed(physical)
    physical, judged, fewer = with_fewer(physical, judged_of(physical))
    refused = (*refused, *fewer)
    found = judged
    judged, force = _with_force(judged)
    refused = (*refused, *_stood_for(found, judged))
    force = (*motors_formulated(judged.physical), *force)
    if judged.is_driven_wrong or motors_read_wrong(judged.physical):
        force = (*force, *motors_described(judged.physical))
    physical = judged.physical
    runs = judged.runs if judged.earned else judged.runs | {"explained": judged.runs["retuned"]}
    values = less_sure(retuned_values(physical), judged.misfit)
    retuned = _determined(values)
    fitted = values if judged.earned else retuned
    left = not judged.settled
    rounded = rounded_sensors(physical, runs["explained"].predicted)
    physics, traces, vague = _named(physical, judged)
    if left:
        physics, force = with_parts(physics, force, over_position(physical.selection))
    physics = [*_drive_physics(physical), *physics, *rounded]
    driven = DRIVEN if judged.is_driven_wrong else READ_WRONG if motors_read_wrong(physical) else ()
    located = {one.block for one in physics} | ({"motor"} if driven else set())
    located |= {one.block for one in force if judged.earned} | {one.block for one in pushes}
    if left and not judged.earned and not driven:
        located |= judged.wrong_sensors or ({"wire"} if wires_are_off(physical) else {"plant"})
    keeps = not left or judged.earned or bool(retuned and _helps(judged))
    alternatives = _alternatives(physical) if judged.earned else ()
    return Part(
        blocks=mismatches(physical, runs, located),
        physics=tuple(physics),
        retuned=retuned if keeps else {},
        alternatives=alternatives,
        fits=fits_of(physical, runs, located or ({"plant"} if retuned else set())),
        detection_limits=detection_limits(physical),
        curves=(
            *force_curve(physical, runs["explained"].predicted, physics),
            *wire_curve(physical, physics),
        ),
        changes={name: one.value for name, one in fitted.items()} if keeps else {},
        effects=(*_effects(physical, judged), *(rounded_section(one) for one in rounded)),
        unexplained=(*driven, *(_left_over(physical, judged) if left else ())),
        notes=(
            *physical.evidence.notes,
            *_on_the_load(physical),
            *inseparable(physics),
            *elsewhere(physics, alternatives),
            *(gains(physics, force) if physical.evidence.driven_by == "force" else ()),
            *(all_alike(retuned) if keeps and physical.evidence.is_forced else ()),
            *offsets(physical, runs["explained"].predicted),
            *loud(physical),
            *([LEFT_OUT] if pushes else []),
            *_undetermined({name: one for name, one in fitted.items() if name not in retuned}),
            *filter(None, [physical.fitting.budget.note]),
        ),
        faults=tuple(zero_faults(physical.own_zeros, physical.evidence.names)),
        described=(*force, *pushes),
        traces=tuple(traces),
        refused=(*refused, *vague, *judged.refused),
        free_run=free_runs(physical, runs),
        recordings=recording_fits(physical, runs),
    )


def _determined(retuned: dict[str, Retuned]) -> dict[str, Retuned]:
    """Those values that the recording determines."""
    return {name: one for name, one in retuned.items() if one.std < max(abs(one.value), abs(one.nominal))}


def _undetermined(values: dict[str, Retuned]) -> tuple[str, ...]:
    """Other values of the model that was found, none of which the recording determines by itself."""
    if not values:
        return ()
    told = enumerated(f"{name} {bare(one.value)} {one.unit}".rstrip() for name, one in values.items())
    return (f"Beside what was found the model has {told}: the recording does not determine that by itself.",)


def _helps(judged: Judgement) -> bool:
    """Whether new values predict unseen data much better, though not to the noise."""
    before, after = judged.squares["nominal"] - judged.expected, judged.squares["retuned"] - judged.expected
    return after < RETUNED_LEFT_SHARE * before


def _with_force(judged: Judgement) -> tuple[Judgement, tuple[Described, ...]]:
    """The force that is left, described, and a formula of it in the model where one was earned."""
    judged = with_changed_mass(judged) or judged
    if not (judged.settled or judged.is_driven_wrong):
        if not judged.earned and wires_are_off(judged.physical):
            composed = compose_wires(judged)
            if composed is None:
                return judged, tuple(wires_described(judged.physical))
            return composed, tuple(formulated(composed))
        if not any(one.in_train for one in judged.left_over):
            return judged, unconfirmed(judged)
        free = told(judged.told_missing.curves)
        plain = plainest(judged.told_missing.curves)
        if plain is not None and (shown := with_shown_kind(judged, plain)) is not None:
            return shown, _beside_shown(shown)
        of_mass = free is not None and free.feature.of_mass and is_foretold(free)
        rests = judged.physical.evidence.comes_to_rest
        composed = None if rests or of_mass else compose_best(judged, free)
        judged = judged if composed is None else each_by_itself(with_kinds(composed))
        if not judged.composed and (some := unconfirmed(judged, from_time_to_time=is_foretold(free))):
            return judged, some
        if not judged.composed:
            if judged.is_astray:
                return judged, ()
            curve = () if free is None else (described(free, when(judged), beside=judged.earned),)
            return judged, curve if is_foretold(free) else unforeseen(judged) or curve
    judged = with_names(with_plainer_terms(with_fewer_kinds(with_fewer_terms(judged))))
    formula = judged.earned and judged.physical.selection.formulas
    return judged, tuple(formulated(judged)) if formula else ()


def _stood_for(before: Judgement, judged: Judgement) -> tuple[Refused, ...]:
    """Kinds that had been earned and are not told beside a formula."""
    selection = judged.physical.selection
    if not (before.earned and judged.earned and selection.formulas):
        return ()
    kept = {tried[0].label for tried in selection.rounds}
    had = (tried[0].label for tried in before.physical.selection.rounds if not tried[0].law.written)
    return tuple(because(label, STOOD_FOR) for label in had if label not in kept)


def _beside_shown(judged: Judgement) -> tuple[Described, ...]:
    """The force that is left beside a kind that a curve showed: a formula would make up for that kind."""
    free = None if judged.settled else told(judged.told_missing.curves)
    return (described(free, when(judged), beside=True),) if free is not None and is_foretold(free) else ()


def _left_over(physical: Physical, judged: Judgement) -> tuple[str, ...]:
    """What is left of each signal, and since when."""
    said = []
    for channel, one in zip(physical.evidence.channels, judged.left_over, strict=True):
        if one.rms > 1.0 and (one.in_train or one.in_held_out or one.parts.size):
            text = (
                f"{channel.signal}: on unseen data the error is {bare(one.rms)} times the noise, "
                "and it is not random."
            )
            said.append(f"{text} {ONLY_UNSEEN}" if _late(one, physical) else text)
    louder = any(one.rms > 1.0 for one in judged.left_over)
    return tuple(said) or (ABOVE_UNSEEN_NOISE if louder else LEFT_OF_FITTED,)


def _late(one: Remainder, physical: Physical) -> bool:
    """Whether nothing shows before the unseen part."""
    return (
        not one.in_train
        and bool(one.parts.size)
        and float(one.parts[:, 0].min()) > LATE_TRAINING_SHARE * physical.train
    )


def _on_the_load(physical: Physical) -> tuple[str, ...]:
    """What was found of the load between its samples, where the recording does not say it."""
    between = physical.experiment.between
    if between is Between.SMOOTH:
        return ()
    return (f"Between its samples the load {between.value}; a smooth curve would explain less.",)


def _named(physical: Physical, judged: Judgement) -> tuple[list[Physics], list[Trace], list[Refused]]:
    """Effects that were earned, those of them that do not matter, and those of which nothing can be said.

    Above the noise what does not matter says nothing.
    """
    selection, found, traces, vague = physical.selection, [], [], []
    if not judged.earned:
        return [], [], []
    for i, share in enumerate(judged.shares[: len(selection.rounds) - selection.formulas]):
        one = selection.best.model.added[i]
        values = less_sure(values_of(selection.best, i), judged.misfit)
        energy = _energy(physical, selection.best.model, i)
        words = physics_words(one.block, one.kind, one.place, values, share, energy)
        if len(selection.rounds) == 1 or not 0.0 <= share < negligible(judged):
            found.append(Physics(one.block, one.kind, one.place, values, words, energy, share))
        elif judged.at_noise:
            traces.append(Trace(one.block, one.kind, share, words))
        else:
            vague.append(because((one.block, one.kind, one.place), ABOVE_NOISE))
    return found, traces, vague


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
    if not drives_earned(physical.drives):
        return []
    found = []
    for i, tried in enumerate(physical.drives):
        if tried[0].law.written:
            continue
        fitted = physical.drives[-1][0].fitted
        one = fitted.model.added[i]
        searched = values_of(fitted, i, tried[0].start.scales)
        values = searched | settled_by_plant(physical, fitted.model.name(i), one)
        before = tried[-1].fitted.squares if len(tried) > 1 else float("nan")
        share = float(1.0 - tried[0].fitted.squares / before) if before > 0.0 else float("nan")
        energy = wire_work(physical.experiment, physical.windows, physical.settled, physical.spec)
        words = physics_words(one.block, one.kind, one.place, values, float("nan"), energy)
        found.append(Physics(one.block, one.kind, one.place, values, words, energy, max(share, 0.0)))
    return found


def _alternatives(physical: Physical) -> tuple[Alternative, ...]:
    """Other kinds that were tried, nearest first."""
    found: list[Alternative] = []
    for tried in physical.drives:
        for other in () if tried[0].law.written else tried[1:4]:
            apart = distinguishable(tried[0].fitted, other.fitted)
            found.append(Alternative("motor", other.label[1], float("nan"), apart))
    selection = physical.selection
    others = [other for tried in selection.rounds for other in tried[1:5]]

    def alternative(other: FittedCandidate) -> Alternative:
        k = channel_of(physical, other.label[0]) or 0
        error = nrmse(physical, simulate_all(physical, other.fitted).predicted, k)
        return Alternative(
            other.label[0], other.label[1], error, distinguishable(selection.best, other.fitted)
        )

    return (*found, *physical.fitting.cores.each_in_parts(alternative, others))


def _effects(physical: Physical, judged: Judgement) -> tuple[dict[str, object], ...]:
    """Sections for the patched spec."""
    sections = []
    if drives_earned(physical.drives):
        model = physical.drives[-1][0].fitted.model
        for i, one in enumerate(model.added):
            told = settled_by_plant(physical, model.name(i), one).items()
            known: dict[str, float | str]
            known = {key: value.value for key, value in told if isinstance(value, Value)}
            sections.append(one.section(model.effect_values(i) | known))
    if not judged.earned:
        return tuple(sections)
    model = physical.selection.best.model
    sections += [one.section(model.effect_values(i)) for i, one in enumerate(model.added)]
    return tuple(sections)
