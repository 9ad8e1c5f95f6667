"""What a diagnosis says is right by a test engineer's measure: digits, bounds, whole sentences."""

from __future__ import annotations

import re

import pytest

from rthm_analysis.diagnosis.computed import words as computed
from rthm_analysis.diagnosis.links import words as links
from rthm_analysis.diagnosis.numbers import NOT_DETERMINED, bare, number, percent, with_unit
from rthm_analysis.diagnosis.result import Retuned, Value
from rthm_analysis.diagnosis.words import physics_words, retuned_words, stated_spreads, verdict_words
from rthm_core.effects import BLOCKS, EffectText, effect, kinds
from rthm_core.spec import apply, shipped_spec


@pytest.mark.parametrize(
    ("value", "std", "unit", "said"),
    [
        (0.11834, 0.0021, "N", "0.1183 +- 0.0021 N"),
        (1234.5, 23.0, "N/m", "1234 +- 23 N/m"),
        (0.25, 0.03, "N s/m", "0.25 +- 0.03 N s/m"),
        (0.00401, 0.00002, "s", "4.010 +- 0.020 ms"),
        (2e-5, 1e-6, "m", "20.0 +- 1.0 um"),
        (3.21e-7, 4e-9, "kg", "(3.21 +- 0.04)e-7 kg"),
        (0.9, 0.02, "1", "0.900 +- 0.020"),
        (0.118, 5.9e-24, "m", "0.118 m"),
        (-4e-13, 5.9e-24, "m", "-4e-13 m"),
        (40.123456, 0.0, "N/m", "40.123456 N/m"),
        (12.0000397, 1e-5, "N/m", "12 N/m"),
        (0.3000000000012, 1e-16, "kg", "0.3 kg"),
        (0.05, float("nan"), "m", "50 mm"),
        (1e-4, 1.5e-4, "m", "at most 0.4 mm"),
        (0.0, 0.1, "N", "at most 0.2 N"),
        (-0.1, 0.08, "N", "between -0.26 and 0.06 N"),
        (1.2, 13.0, "1", NOT_DETERMINED),
        (5.7, float("inf"), "rad/s", NOT_DETERMINED),
        (float("nan"), 1.0, "N", NOT_DETERMINED),
    ],
)
def test_a_number_has_the_digits_that_it_deserves(value: float, std: float, unit: str, said: str) -> None:
    assert number(value, std, unit) == said


def test_a_coefficient_of_either_sign_is_bounded_on_both_sides() -> None:
    assert number(1.0, 0.8, "N/m^3", signed=True) == "between -0.6 and 2.6 N/m^3"
    assert number(1.0, 0.8, "N/m^3") == "at most 2.6 N/m^3"


def test_parts_and_plain_numbers() -> None:
    assert [percent(p) for p in (0.93, 0.9998, 1.0, 0.042, 0.00123, 0.999999999)] == [
        "93 %", "99.98 %", "100 %", "4.2 %", "0.12 %", "100 %",
    ]  # fmt: skip
    assert [bare(x) for x in (2.0, 0.4, 100.0, 12345.6, 0.0, 1.2e-7)] == [
        "2", "0.4", "100", "12300", "0", "1.2e-7",
    ]  # fmt: skip
    assert with_unit(0.00039, "m", 2) == "0.39 mm" and with_unit(0.5, "m") == "0.5 m"


ODD = re.compile(r"\+- \d[^ ]*e-[1-9]\d|per metre|remember|[{}]|  |\bnan\b|the the|sensor\.")
EVERY = [(block, kind) for block in BLOCKS for kind in kinds(block)]


@pytest.mark.parametrize(("block", "kind"), EVERY)
@pytest.mark.parametrize("std", [0.02, 1e-19, 0.8, 9.0])
def test_every_kind_is_told_in_whole_sentences(block: str, kind: str, std: float) -> None:
    declared = effect(kind, block)
    values = {
        key: "numerical.mass" if isinstance(entry, EffectText) else Value(1.5, std, declared.unit(key, block))
        for key, entry in declared.parameters.items()
    }
    said = physics_words(block, kind, "x1", values, 0.93, -0.41)
    assert not ODD.search(said), said
    assert said[0].isupper() and said.endswith("Over the recording it took out 0.41 J.")
    assert "It removes 93 % of the squared error" in said
    if std == 0.02 and not any(isinstance(one, str) for one in values.values()):
        assert said.count("1.500 +- 0.020") == len(values)


def test_a_value_at_the_end_of_what_is_possible_is_said_to_be_there() -> None:
    values = {"alpha": Value(2.0, 0.1, "N/m"), "n": Value(20.0, 0.5, "1")}
    rest = {"A": Value(1.0, 0.0, "1"), "beta": Value(1.0, 0.1, "1"), "gamma": Value(1.0, 0.1, "1")}
    said = physics_words("plant", "bouc_wen", "x1", {**values, **rest}, float("nan"), 0.0)
    assert "Its n is the largest that is possible." in said
    assert "alpha is the" not in said


def test_new_values_of_parameters_are_compared_with_what_the_spec_states() -> None:
    spec = apply(shipped_spec("decay"), {"uncertainty.plant.damping": 0.5})
    stated = stated_spreads(spec)
    found = {
        "plant.mass": Retuned(1.2, 1.164, 0.004, "kg"),
        "plant.damping": Retuned(0.05, 0.15, 0.01, "N s/m"),
        "plant.stiffness": Retuned(12.0, 12.1, 0.01, "N/m"),
    }
    said = retuned_words(found, stated)
    assert "plant.mass 1.164 +- 0.004 kg instead of 1.2 kg (-3.0 %, though the spec calls it exact)" in said
    assert "(+200 %, 4 times the uncertainty that the spec states)" in said
    assert "exact" not in retuned_words(found)
    assert "+- is one standard deviation" in verdict_words("retuned", ("plant",), (), found, stated)


@pytest.mark.parametrize(
    ("value", "nominal", "said"),
    [
        (12.0 + 1e-11, 12.0, "plant.stiffness as specified, 12 N/m"),
        (12.345, 12.34501, "plant.stiffness 12.345 N/m instead of 12.35 N/m"),
        (12.35, 12.3456, "plant.stiffness 12.35 N/m instead of 12.346 N/m"),
    ],
)
def test_a_new_value_is_never_told_as_if_it_were_the_old_one(value: float, nominal: float, said: str) -> None:
    assert retuned_words({"plant.stiffness": Retuned(nominal, value, 1e-12, "N/m")}).startswith(said)


def test_what_is_not_explained_names_nothing() -> None:
    said = verdict_words("unexplained", ("plant",), (), {})
    assert said.endswith("no known kind of physics explains it.")


def test_links_and_blocks_that_compute_are_told_with_their_digits() -> None:
    early = links.sentence("tau4", "extra_delay", Value(-0.002, 1e-6, "s"), 0.9999)
    assert "arrive 2.0000 +- 0.0010 ms earlier than the spec says" in early and "99.99 %" in early
    lost = links.sentence("tau2", "loss", Value(0.0123, 0.001, "1"), 0.5)
    assert "1.23 +- 0.10 % never arrive" in lost
    wrong = computed.wrong("controller", "actuator.stiffness", 40.0, Value(44.25, 1e-13, "N/m"), 1.0, "")
    assert "actuator.stiffness = 44.25 N/m; the spec says 40 N/m (+10.62 %)" in wrong
    assert "+-" not in wrong and "100 %" in wrong
