"""A law that a spec writes down is simulated as the same law of the library, and computes nothing else."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_core.effects import effect
from rthm_core.effects.formula import FUNCTIONS, evaluated, parsed, without
from rthm_core.effects.written import Formula
from rthm_core.engine import Trajectory, simulate
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, read_spec, shipped_spec, write_spec


def with_force(**section: Any) -> Spec:
    return apply(
        shipped_spec("paper"), {"effects": ["one"], "one": {"block": "plant", "dof": "x1"} | section}
    )


def acting(**section: Any) -> Any:
    """Motion (s, n) of the paper's loop with one effect."""
    spec = apply(shipped_spec("paper"), {"effects": ["one"], "one": section})
    return simulate(spec, 8.0, 0.01).plant_position


def rig(**section: Any) -> Trajectory:
    return simulate(with_force(**section), 8.0, 0.01)


@pytest.mark.parametrize(
    ("library", "written"),
    [
        ({"kind": "cubic_stiffness", "coefficient": 40.0}, {"force": "-a * x**3", "a": 40.0}),
        ({"kind": "quadratic_drag", "coefficient": 1.0}, {"force": "-a * sign(v) * v**2", "a": 1.0}),
        ({"kind": "quadratic_drag", "coefficient": 1.0}, {"force": "-a * abs(v) * v", "a": 1.0}),
        (
            {"kind": "clearance", "gap": 0.05, "stiffness": 9.0},
            {"force": "-a * sign(x) * max(abs(x) - b, 0)", "a": 9.0, "b": 0.05},
        ),
        (
            {"kind": "harmonic_load", "amplitude": 0.3, "frequency": 4.0, "phase": 0.5},
            {"force": "a * sin(b * t + c)", "a": 0.3, "b": 4.0, "c": 0.5},
        ),
    ],
)
def test_a_law_of_the_library_that_is_written_down_is_the_same(
    library: dict[str, Any], written: dict[str, Any]
) -> None:
    known, formula = rig(**library), rig(kind="formula", **written)
    apart = np.abs(known.plant_position - formula.plant_position).max()
    assert apart < 1e-6 * np.abs(known.plant_position).max()
    linear = rig(kind="formula", force="0 * x")
    assert np.abs(known.plant_position - linear.plant_position).max() > 1e-3


@pytest.mark.parametrize(
    ("block", "library", "written"),
    [
        (
            "wire",
            {"kind": "hardening", "coefficient": 2000.0},
            {"force": "a * elongation**3", "a": 2000.0},
        ),
        ("motor", {"kind": "saturation", "limit": 0.05}, {"shift": "min(max(u, -a), a) - u", "a": 0.05}),
    ],
)
def test_a_wire_and_a_motor_may_have_formulas(
    block: str, library: dict[str, Any], written: dict[str, Any]
) -> None:
    laws = (library, {"kind": "formula"} | written)
    known, formula = (acting(block=block, actuator="a1", **law) for law in laws)
    linear = simulate(shipped_spec("paper"), 8.0, 0.01).plant_position
    apart = np.abs(known - formula).max()
    assert apart < 1e-7 * np.abs(known).max()
    assert np.abs(known - linear).max() > 1e-3


def test_what_a_motor_adds_may_depend_on_the_time_at_which_it_takes_a_command() -> None:
    from_two_on = acting(
        block="motor", actuator="a1", kind="formula", shift="a * (t - b) * (b < t)", a=0.1, b=2.0
    )
    linear = simulate(shipped_spec("paper"), 8.0, 0.01).plant_position
    before = np.arange(linear.shape[0]) * 0.01 <= 2.0
    assert np.abs(from_two_on - linear)[before].max() < 1e-9
    assert np.abs(from_two_on - linear)[~before].max() > 0.01


@pytest.mark.parametrize(
    ("block", "entry", "text", "unknown"),
    [("wire", "force", "a * x", "x"), ("motor", "shift", "a * elongation", "elongation")],
)
def test_a_formula_of_what_its_block_does_not_know_is_refused(
    block: str, entry: str, text: str, unknown: str
) -> None:
    with pytest.raises(InputError, match=f"one.{entry} is .* {unknown} is unknown"):
        acting(block=block, actuator="a1", kind="formula", a=1.0, **{entry: text})


def test_a_force_begins_and_ends_where_the_formula_says() -> None:
    linear = rig(kind="formula", force="0 * x").plant_position[:, 0]
    caught = rig(kind="formula", force="-a * x * (b < t) * (t < c)", a=8.0, b=2.0, c=4.0).plant_position[:, 0]
    before = np.arange(linear.size) * 0.01 <= 2.0
    assert np.abs(caught - linear)[before].max() < 1e-9
    assert np.abs(caught - linear)[~before].max() > 0.01


def loaded(amplitude: float, effects: dict[str, dict[str, Any]]) -> Any:
    """Motion (s, n) of the loop with a harmonic load on the plant and effects there."""
    load = {"kind": "harmonic", "amplitude": amplitude, "frequency": 3.0, "phase": 0.4}
    on_plant = {name: {"block": "plant", "dof": "x1"} | one for name, one in effects.items()}
    changes = {f"load.plant.{key}": value for key, value in load.items()}
    spec = apply(shipped_spec("paper"), changes | {"effects": list(on_plant)} | on_plant)
    return simulate(spec, 8.0, 0.01).plant_position


@pytest.mark.parametrize("beside", [{}, {"more": {"kind": "constant_load", "force": 0.2}}])
def test_a_law_of_the_load_changes_the_load_and_nothing_beside_it(beside: dict[str, dict[str, Any]]) -> None:
    half = {"kind": "formula", "force": "a * load", "a": 0.5}
    known, more = loaded(0.3, beside | {"law": half}), loaded(0.45, beside)
    assert np.abs(known - more).max() < 1e-7 * np.abs(more).max()
    assert np.abs(loaded(0.3, beside) - more).max() > 1e-3


def test_without_a_load_a_law_of_the_load_does_nothing() -> None:
    law = rig(kind="formula", force="a + b * load * abs(load)", a=0.1, b=7.0)
    constant = rig(kind="constant_load", force=0.1)
    assert np.abs(law.plant_position - constant.plant_position).max() < 1e-9


def test_a_spec_with_a_formula_is_written_and_read_again(tmp_path: Any) -> None:
    spec = with_force(kind="formula", force="-a * tanh(x / b)", a=2.0, b=0.1)
    file = tmp_path / "spec.yaml"
    file.write_text(write_spec(spec))
    assert read_spec(file).effects == spec.effects


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')", "x.real", "x[0]", "lambda: 1", "'x' * 3", "a if x else v", "y * a", "a +",
        "a @ x", "a < x < 3", "open(x)", "sin", "x and v", "[x]", "x == v",
        "sin(x, key=1)", "True * x", "(x := 1)", "a" * 300,
    ],
)  # fmt: skip
def test_what_is_no_arithmetic_is_refused_in_one_sentence(text: str) -> None:
    with pytest.raises(InputError, match=r"one\.force is .* must be") as error:
        with_force(kind="formula", force=text, a=1.0)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ({"force": "-a * x"}, "one.a is missing, but must be given"),
        ({"force": "-a * x", "a": 1.0, "b": 2.0}, "one.b is 2.0, but must be left out"),
        ({}, "one.force is missing, but must be given"),
        ({"force": 3.0}, "one.force is 3.0, but must be"),
    ],
)
def test_numbers_that_a_formula_lacks_or_does_not_use_are_told(section: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as error:
        with_force(kind="formula", **section)
    assert words in str(error.value)


def test_powers_of_whole_numbers_take_no_time() -> None:
    law: Any = Formula.of("9**9**9 * x")
    with pytest.raises(OverflowError):
        law.force(1.0, 0.0, [], 0.0, (), 1)


def test_a_law_declares_what_its_formula_uses() -> None:
    law = Formula.of("-a * sign(v) * (b < x) * (x < c) * (t < d)")
    assert law.depends_on == ("x", "v", "t")
    assert list(law.parameters) == ["force", "a", "b", "c", "d"]
    assert law.partition == "velocity"
    assert law.kinked
    assert Formula.of("a * sin(t)").additive
    assert not Formula.of("a * x").additive
    assert effect("formula", "plant").given({"force": "-a * x"}) is Formula.of("-a * x")


def test_a_number_of_a_formula_has_any_size() -> None:
    """Micrometres to the third power make large ones."""
    one = with_force(kind="formula", force="-a * v * x**2", a=6.5e17).effects[0]
    assert one.numbers == {"a": 6.5e17}
    with pytest.raises(InputError):
        with_force(kind="formula", force="-a * v * x**2", a=math.inf)


NUMBER = st.floats(-3.0, 3.0).map(lambda value: round(value, 3))


@st.composite
def texts(draw: st.DrawFn, depth: int = 3) -> str:
    if depth == 0 or draw(st.booleans()):
        return draw(st.sampled_from(["x", "v", "t", "a", "b", "pi", "2", "0.5"]))
    left, right = draw(texts(depth - 1)), draw(texts(depth - 1))
    form = draw(
        st.sampled_from(["({l} + {r})", "({l} - {r})", "({l} * {r})", "({l} < {r})", "-{l}", "{f}({l})"])
    )
    alone = [name for name in FUNCTIONS if name not in ("min", "max", "sqrt", "log", "exp", "tan")]
    return form.format(l=left, r=right, f=draw(st.sampled_from(alone)))


@given(texts(), NUMBER, NUMBER, st.floats(0.0, 3.0), NUMBER, NUMBER)
def test_a_law_and_its_formula_along_arrays_are_one(
    text: str, x: float, v: float, t: float, a: float, b: float
) -> None:
    law, numbers = Formula.of(text), {"a": a, "b": b}
    p = tuple(numbers[name] for name in parsed(text, Formula.variables()).numbers)
    mode = (v > 0.0) - (v < 0.0)
    once = law.force(x, v, [], t, p, mode)
    many = evaluated(text, numbers, x=np.full(2, x), v=np.full(2, v), t=np.full(2, t))
    assert math.isclose(once, many[0], rel_tol=1e-9, abs_tol=1e-9) or "sign(" in text


@pytest.mark.parametrize(
    ("text", "shorter"),
    [
        ("a * sin(2 * pi * x / b + c)", "a * sin(2 * pi * x / b)"),
        ("a * (c - x)", "a * -x"),
        ("a * v * exp(-((x - c) / b)**2)", "a * v * exp(-(x / b)**2)"),
        ("a * x * max(t - c, 0)", "a * x * t"),
        ("a / (c - x)**2", "a / (-x)**2"),
        ("a * sign(x) * max(abs(x) - c, 0)", "a * sign(x) * abs(x)"),
    ],
)
def test_a_number_that_is_only_added_may_be_left_out(text: str, shorter: str) -> None:
    assert without(text, "c") == shorter
    x, v, t = np.random.default_rng(1).uniform(0.1, 1.0, (3, 20))
    numbers = {"a": 2.0, "b": 0.7}
    whole = evaluated(text, numbers | {"c": 0.0}, x=x, v=v, t=t)
    assert evaluated(shorter, numbers, x=x, v=v, t=t) == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("text", ["a * sin(c * x)", "a * (c < t)", "a * x * (b + c * v)"])
def test_a_number_that_is_anything_else_stays(text: str) -> None:
    assert without(text, "c") is None
