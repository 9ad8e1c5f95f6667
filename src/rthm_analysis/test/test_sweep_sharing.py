"""Loops of a sweep share what they have in common: they find what each finds alone."""

import numpy as np
import pytest

from rthm_analysis.sweep.batch import Order, run_batch
from rthm_analysis.sweep.points import SCALE, Points, changed, grid, sharing_order
from rthm_analysis.sweep.quantities import measure
from rthm_analysis.sweep.ranges import given_range
from rthm_core.compensators import NAMES
from rthm_core.errors import InputError
from rthm_core.kept import RESULTS_KEPT, kept_by_clocks, kept_without_timing
from rthm_core.spec import apply, shipped_spec

PAPER = shipped_spec("paper")
LATE = {"late.block": "link.tau1", "late.kind": "extra_delay", "late.delay": 0.001}
GUIDE = {"guide.block": "plant", "guide.kind": "coulomb_friction", "guide.force": 0.05}
SHAKEN = {"load.plant": {"kind": "harmonic", "amplitude": 0.3, "frequency": 5.0, "phase": 0.4}}

SWEEPS = {
    "clocks and numbers": (PAPER, ("timing.tau4=0,0.0123,0.4", "plant.damping=0.01,0.05")),
    "numbers alone": (PAPER, ("actuator.stiffness=5,40", "numerical.mass=0.7,1.5")),
    "all times": (PAPER, (f"{SCALE}=0.5,1.5,30", "interface.stiffness=4,6")),
    "periods": (PAPER, ("timing.td1=0.0012,0.0017", "timing.td3=0.004,0.0041", "plant.mass=1,2")),
    "compensated": (
        apply(PAPER, {"actuator.compensator": NAMES[-1]}),
        ("timing.tau4=0.01,0.03", "actuator.stiffness=20,40"),
    ),
    "motors": (
        apply(PAPER, {"actuator.motor_poles": [200.0, 500.0]}),
        ("actuator.motor_poles[0]=100,300", "timing.tau3=0.001,0.02"),
    ),
    "a link": (
        apply(PAPER, {"effects": ["late"], **LATE}),
        ("late.delay=-0.003,0.002", "timing.tau1=0.004,0.002"),
    ),
    "a load": (apply(PAPER, SHAKEN), ("load.plant.amplitude=0.1,0.4", "timing.tau2=0.001,0.01")),
    "not linear": (
        apply(PAPER, {"effects": ["guide"], **GUIDE}),
        ("guide.force=0.02,0.05", "timing.tau4=0.005,0.01"),
    ),
    "noise": (shipped_spec("paper_noisy"), ("noise.position=0,0.001", "timing.tau4=0.005,0.01")),
    "several dofs": (shipped_spec("three_mass"), ("plant.mass[0]=1,1.5", "timing.tau4=0.005,0.02")),
    "a pulley": (shipped_spec("transmission"), ("actuator.transmission.wire=900,1100", "timing.tau1=0,0.01")),
}


def swept(spec, given, duration):
    """A batch of every combination, and its keys."""
    ranges = [given_range(text) for text in given]
    keys, values = tuple(one.key for one in ranges), grid(ranges)
    return keys, run_batch(Order(spec.expanded(), keys, duration), np.arange(values.shape[0]), values)


def alone(spec, keys, values, duration):
    """Quantities and sentence of a loop that has no section in common with any other."""
    try:
        with np.errstate(all="ignore"):
            return measure(changed(spec.model_copy(deep=True), keys, values), duration)
    except InputError as error:
        return {}, str(error)


@pytest.mark.parametrize("name", SWEEPS)
def test_loops_of_a_batch_find_what_each_finds_alone(name):
    spec, given = SWEEPS[name]
    keys, batch = swept(spec, given, 1.0)
    for row, values in enumerate(batch.values):
        expected, refused = alone(spec, keys, values, 1.0)
        assert batch.found["refused"][row] == refused
        found = {quantity: batch.found[quantity][row] for quantity in expected}
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-12, nan_ok=True)


def test_a_sweep_has_stable_and_unstable_loops_and_tells_them_apart():
    _, batch = swept(*SWEEPS["clocks and numbers"], 0.0)
    assert batch.found["stable"] == [True, True, True, True, False, False]


def test_what_is_refused_has_the_sentence_of_the_whole_spec():
    given = ("timing.tau4=-1,0.01", "plant.damping=0.05", "numerical.mass=-2,1.5")
    keys, batch = swept(PAPER, given, 0.0)
    assert [bool(sentence) for sentence in batch.found["refused"]] == [True, True, True, False]
    assert ["tau4" in sentence for sentence in batch.found["refused"]] == [True, True, False, False]
    assert "numerical.mass" in batch.found["refused"][2]
    for sentence, values in zip(batch.found["refused"], batch.values, strict=True):
        assert sentence == alone(PAPER, keys, values, 0.0)[1]


def test_a_delay_that_an_effect_takes_away_is_refused_with_its_sentence():
    keys, batch = swept(*SWEEPS["a link"], 0.0)
    refused = dict(zip(map(tuple, batch.values), batch.found["refused"], strict=True))
    assert "late.delay" in refused[-0.003, 0.002]
    assert [sentence for values, sentence in refused.items() if values != (-0.003, 0.002)] == ["", "", ""]
    assert keys == ("late.delay", "timing.tau1")


def test_a_part_that_is_refused_alone_is_allowed_where_the_whole_is():
    spec = apply(PAPER, {"effects": ["late"], **LATE, "timing.tau1": 0.001})
    at = Points(spec, ("late.delay", "timing.tau1")).at([-0.003, 0.004])
    assert at == changed(spec, ("late.delay", "timing.tau1"), [-0.003, 0.004])


def test_loops_share_the_sections_in_which_they_do_not_differ():
    points = Points(PAPER, ("timing.tau4", "plant.damping"))
    first, later, other = (points.at(values) for values in ([0.01, 0.05], [0.02, 0.05], [0.01, 0.06]))
    assert first.plant is later.plant and first.timing is other.timing
    assert first.timing is not later.timing and first.plant is not other.plant
    assert first == changed(PAPER, ("timing.tau4", "plant.damping"), [0.01, 0.05])


def test_the_order_of_work_brings_loops_with_the_same_numbers_together():
    values = grid([given_range("a=1:5:5"), given_range(f"b=0:1:{2 * RESULTS_KEPT}"), given_range("c=1,2")])
    order = sharing_order(("plant.mass", "timing.tau4", "timing.tau1"), values)
    assert np.array_equal(np.sort(order), np.arange(values.shape[0]))
    mass = values[order, 0]
    changes = np.count_nonzero(np.diff(mass))
    assert changes < 5 * (4 * RESULTS_KEPT / (RESULTS_KEPT // 2))
    for begin in range(0, values.shape[0], RESULTS_KEPT):
        timings = np.unique(values[order[begin : begin + RESULTS_KEPT], 1:], axis=0)
        assert timings.shape[0] <= RESULTS_KEPT


@pytest.mark.parametrize("keys", [("plant.mass",), ("timing.tau4",)])
def test_loops_of_one_key_are_run_from_the_least_value_to_the_largest(keys):
    assert sharing_order(keys, np.array([[2.0], [1.0], [3.0]])).tolist() == [1, 0, 2]


def test_what_follows_from_numbers_is_kept_over_changes_of_the_clocks_alone():
    calls = []
    of_numbers = kept_without_timing(lambda spec: calls.append("numbers") or spec.plant.mass)
    of_clocks = kept_by_clocks(lambda spec: calls.append("clocks") or spec.timing.tau4)
    for changes in ({}, {"timing.tau4": 0.02}, {"plant.mass": 2.0}, {"effects": ["late"], **LATE}):
        one = apply(PAPER, changes) if changes else PAPER
        assert of_numbers(one) == one.plant.mass and of_clocks(one) == one.timing.tau4
    assert calls == ["numbers", "clocks", "clocks", "numbers", "numbers", "clocks"]
