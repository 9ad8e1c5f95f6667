"""Effects that no recording of a motion tells apart are said to be so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical.inseparable import all_alike, elsewhere, gains, inseparable
from rthm_analysis.diagnosis.physical.parts_of_force import with_parts
from rthm_analysis.diagnosis.result import Alternative, Described, Physics, Retuned, Value


def _found(kind: str, place: str = "x1", **sizes: float) -> Physics:
    return Physics("plant", kind, place, {k: Value(v, 0.1, "N") for k, v in sizes.items()}, "", 0.0, 1.0)


def test_an_offset_beside_dry_friction_may_be_friction_that_differs_with_the_direction() -> None:
    (said,) = inseparable([_found("constant_load", force=2.0), _found("coulomb_friction", force=20.0)])
    assert "friction of 18 N towards +x and 22 N towards -x" in said


@pytest.mark.parametrize(
    "others",
    [
        [_found("constant_load", force=2.0)],
        [_found("coulomb_friction", force=20.0)],
        [_found("constant_load", "x2", force=2.0), _found("coulomb_friction", force=20.0)],
        [_found("quadratic_drag", coefficient=2.0), _found("coulomb_friction", force=20.0)],
    ],
)
def test_what_a_motion_tells_apart_has_no_such_note(others: list[Physics]) -> None:
    assert not list(inseparable(others))


def _left(*depends_on: str, size: float, place: str = "x1") -> Described:
    at = np.linspace(-1.0, 1.0, 5)
    return Described(
        "plant", place, depends_on, "neither", False, False, None, None, {}, 0.9, 0.9,
        at, size * at, np.full(5, 0.01), "",
    )  # fmt: skip


def test_a_constant_beside_an_unknown_force_over_the_position_may_be_part_of_it() -> None:
    named = [_found("constant_load", force=50.0), _found("quadratic_drag", coefficient=2.0)]

    kept, (whole,) = with_parts(named, [_left("x", "v", size=30.0)])

    assert [one.kind for one in kept] == ["quadratic_drag"]
    assert whole.force == pytest.approx(np.linspace(20.0, 80.0, 5))
    assert "a constant force of 50.00 +- 0.10 N" in whole.words


def test_a_spring_beside_a_formula_of_the_position_is_a_term_of_it() -> None:
    spring = _found("cubic_stiffness", coefficient=4.0)
    left = replace(_left("x", "v", size=30.0), formula="30 * (x - sin(x))")

    kept, (whole,) = with_parts([spring], [left], {"x1"})

    assert not kept
    assert whole.formula == "-4 * x**3 + 30 * (x - sin(x))"
    assert whole.force == pytest.approx(30.0 * whole.at - 4.0 * whole.at**3)


@pytest.mark.parametrize("places", [set(), {"x2"}])
def test_a_spring_beside_other_forces_keeps_its_name(places: set[str]) -> None:
    spring, left = _found("cubic_stiffness", coefficient=4.0), _left("x", "v", size=30.0)

    assert with_parts([spring], [replace(left, formula="30 * x**2 * v")], places)[0] == [spring]


@pytest.mark.parametrize(
    ("left", "others"),
    [
        (_left("x", size=3.0), []),  # far smaller
        (_left("v", size=30.0), []),
        (_left("x", size=30.0, place="x2"), []),
        (_left("x", size=30.0), [_found("coulomb_friction", force=20.0)]),  # said otherwise
    ],
)
def test_a_constant_of_its_own_keeps_its_name(left: Described, others: list[Physics]) -> None:
    kept, whole = with_parts([_found("constant_load", force=50.0), *others], [left])

    assert "constant_load" in {one.kind for one in kept}
    assert whole == (left,)


@pytest.mark.parametrize(
    ("on", "words"), [(("load",), "another gain of"), (("load", "t"), "that changes with")]
)
def test_a_force_that_goes_with_the_load_may_be_a_gain(on: tuple[str, ...], words: str) -> None:
    (said,) = gains([], [_left(*on, size=3.0)])
    assert words in said and "load cell" in said


@pytest.mark.parametrize(
    ("named", "on"),
    [([], ("x", "load")), ([], ("x",)), ([_found("coulomb_friction", force=20.0)], ("load",))],
)
def test_what_depends_on_the_motion_is_no_gain(named: list[Physics], on: tuple[str, ...]) -> None:
    assert not list(gains(named, [_left(*on, size=3.0)]))


SCALE = Physics("sensor.velocity", "scale", "x1", {"scale": Value(0.93, 0.001, "1")}, "", 0.0, 1.0)
OTHER = Alternative("sensor.position", "scale", 0.01, distinguishable=False)


def test_what_another_block_explains_as_well_is_told() -> None:
    (said,) = elsewhere([SCALE], [OTHER])
    assert "scale of the velocity sensor" in said and "scale of the position sensor" in said


@pytest.mark.parametrize(
    ("named", "other"),
    [
        ([SCALE], replace(OTHER, distinguishable=True)),
        ([SCALE], replace(OTHER, block=SCALE.block)),
        ([SCALE, SCALE], OTHER),
        ([], OTHER),
    ],
)
def test_what_is_ruled_out_or_no_answer_by_itself_is_not_told(
    named: list[Physics], other: Alternative
) -> None:
    assert not list(elsewhere(named, [other]))


@pytest.mark.parametrize(
    ("formula", "is_said"),
    [
        ("-0.315 * sign(v) * (25 < t) + 0.05 * load", True),
        ("0.05 * load - 0.315 * sign(v) * (25 < t)", True),
        ("-5e-05 * load + 0.2 * v", True),
        ("0.05 * load**2 - 0.315 * sign(v)", False),
        ("0.05 * load * v", False),
    ],
)
def test_a_part_that_goes_with_the_load_may_be_a_gain_beside_larger_forces(
    formula: str, is_said: bool
) -> None:
    left = replace(_left("v", "t", "load", size=3.0), formula=formula)
    assert bool(list(gains([], [left]))) is is_said


@pytest.mark.parametrize(("stiffness", "is_said"), [(95.2, True), (100.0, False), (94.0, False)])
def test_values_that_are_all_off_by_one_factor_may_be_a_gain(stiffness: float, is_said: bool) -> None:
    retuned = {
        "plant.mass": Retuned(1.0, 0.952, 1e-4),
        "plant.damping": Retuned(2.0, 1.9042, 1e-3),
        "plant.stiffness": Retuned(100.0, stiffness, 1e-2),
    }
    assert bool(list(all_alike(retuned))) is is_said
