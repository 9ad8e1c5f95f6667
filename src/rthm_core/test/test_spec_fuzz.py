"""Whatever is read as a spec gives a spec or one sentence, never another exception."""

from __future__ import annotations

from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from rthm_core.errors import InputError
from rthm_core.spec import apply, read_spec, shipped_spec, shipped_text, spec_from_parameters, write_spec

TEXT = shipped_text("transmission") + (
    '    load: {plant: {kind: multisine, rms: 1, low: 1, high: 9, count: 3}, numerical: {kind: none}}\n'
    "    noise: {force: 0.1, seed: 1}\n"
    "    limits: {command: 1.0}\n"
    "    effects: [guide, wrong, late]\n"
    "    guide: {block: plant, kind: bouc_wen, dof: x1, alpha: 1, beta: 2, gamma: 3}\n"
    "    wrong: {block: controller, kind: wrong_parameter, name: actuator.stiffness, value: 30}\n"
    "    late: {block: link.tau1, kind: jitter, std: 1e-3}\n"
)  # fmt: skip
VALUES = [
    *("-1", "0", "1", "nan", ".inf", "1e400", "1e-3", "010", "0x1", "1:30", "99999999999999999999", "1.5"),
    *("[]", "[1", "[1,2]", "[1,true]", "[[1]]", "[{a:1}]", "{}", "{a:1}", "{kind:none}", "[x1,x1]"),
    *("x1", "~", "true", "y", "none", "link.tau1", "é", '""', "''", '"\\0"', '"\\ud800"', "<<", "."),
    *("*a", "&a", "!!binary", "!foo", "?", "|", ">", "-", "%", "@", "`", ""),
]
FAST = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))


def gives_a_spec_or_a_sentence(text: str) -> None:
    try:
        spec = read_spec(text)
    except InputError as error:
        told = str(error)
        assert told.isprintable()
        assert told.endswith(".")
        assert len(told) < 1000
    else:
        assert read_spec(write_spec(spec)) == spec


@st.composite
def mutated(draw: st.DrawFn) -> str:
    lines = TEXT.splitlines()
    for _ in range(draw(st.integers(1, 3))):
        at, other = draw(st.integers(0, len(lines) - 1)), draw(st.integers(0, len(lines) - 1))
        column = draw(st.integers(0, len(lines[at])))
        what = draw(st.integers(0, 4))
        if what == 0:
            lines[at] = f"{lines[at].partition(':')[0]}: {draw(st.sampled_from(VALUES))}"
        elif what == 1:
            lines[at] = lines[at][:column] + draw(st.characters()) + lines[at][column + 1 :]
        elif what == 2:
            lines[at] = lines[at][:column] + lines[at][column + draw(st.integers(0, 9)) :]
        elif what == 3:
            lines[at] = lines[other]
        else:
            lines = lines[:at] + lines[at + draw(st.integers(0, 3)) :] or [""]
    return "\n".join(lines)


@FAST
@given(mutated())
def test_a_damaged_spec_gives_a_spec_or_a_sentence(text: str) -> None:
    gives_a_spec_or_a_sentence(text + "\n")


@FAST
@given(st.text())
@example("\0")
@example("a" * 100_000)
@example(": ")
@example("/**: {ros__parameters: {" + "a: {" * 2000)
def test_any_text_gives_a_spec_or_a_sentence(text: str) -> None:
    gives_a_spec_or_a_sentence(text)


SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
NESTED = st.recursive(
    SCALARS | st.sampled_from(VALUES),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner),
    max_leaves=5,
)
NAMES = st.sampled_from(
    ["plant.mass", "plant", "effects", "guide.kind", "load.plant.kind", "timing.tau1", "noise.seed", "a"]
)


@FAST
@given(st.dictionaries(NAMES | st.text(max_size=5), NESTED, max_size=3))
def test_any_parameters_and_any_change_give_a_spec_or_a_sentence(given_values: dict[str, object]) -> None:
    for make in (spec_from_parameters, lambda changes: apply(shipped_spec("friction"), changes)):
        try:
            make(given_values)
        except InputError as error:
            assert str(error).isprintable()  # noqa: PT017 - both outcomes are right
