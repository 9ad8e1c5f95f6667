"""What wires and motors do beside the spec is told as a formula, where their own sensors show it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rthm_analysis.diagnosis.missing.sampled import fitted_terms, sampled
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.side import diagnose_physical
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.result import Part
from rthm_core.effects.formula import evaluated
from rthm_core.physical.side import first_command

from .side import DUE, EVIDENCE, PAPER, having, simulated

TIME = np.arange(12000) * 0.002
PATH = 0.03 * np.sin(3.0 * TIME) * np.exp(-TIME / 20.0) + 0.01 * np.sin(7.1 * TIME)
NOISE = 1e-3
FIRST = first_command(PAPER)
MOVES = (0.2 * np.sin(17e-9 * DUE) + 0.1 * np.sin(41e-9 * DUE)).reshape(-1, 1)

SCREW = {"shift": "a * sin(2 * pi * u / b)", "a": 2e-3, "b": 0.05}
CREEP = {"shift": "a * t", "a": 2e-3}
LIMP = {"force": "a * max(-elongation, 0)", "a": 15.0}


@pytest.mark.parametrize(
    ("variable", "over", "law", "factors"),
    [
        ("elongation", PATH, 18.0 * np.maximum(-PATH, 0.0), ["max(b - elongation, 0)"]),
        (
            "elongation", PATH, 60.0 * (0.02 * np.tanh(PATH / 0.02) - PATH),
            ["elongation", "tanh(elongation / b)"],
        ),
        ("elongation", PATH, 2000.0 * PATH**3, ["elongation**3"]),
        ("u", PATH, 0.02 * np.sin(2.0 * np.pi * PATH / 0.011 + 0.5), ["sin(2 * pi * u / b + c)"]),
        ("t", TIME, 0.003 * TIME, ["t"]),
        ("u", PATH, 0.0 * PATH, []),
    ],
    ids=["limp", "gives way", "hardens", "screw", "creeps", "nothing"],
)  # fmt: skip
def test_the_law_of_samples_is_found(
    variable: str, over: np.ndarray, law: np.ndarray, factors: list[str]
) -> None:
    noise = NOISE * np.random.default_rng(3).standard_normal(over.size)
    terms = fitted_terms(sampled(variable, over, law + noise, NOISE), "a1")
    assert [one.factors for one in terms] == factors
    found = [one.size * evaluated(one.factors, one.numbers, **{variable: over}) for one in terms]
    assert np.abs(sum(found, np.zeros(over.size)) - law).max() < max(0.01 * np.abs(law).max(), 1e-9)


@pytest.mark.parametrize(
    ("block", "law"), [("motor", SCREW), ("motor", CREEP), ("wire", LIMP)], ids=["screw", "creeps", "limp"]
)
def test_replay_moves_formulas_as_the_engine_does(block: str, law: dict[str, Any]) -> None:
    spec = having(block, "formula", **law)
    measured = simulated(spec)
    experiment = Experiment(EVIDENCE, FIRST)
    runs = Windows(np.array([0]), measured[:1, :2], None)
    predicted = experiment.predicted(spec, runs)
    assert np.abs(predicted - measured).max() < 1e-5 * np.abs(measured).max()
    plain = experiment.predicted(PAPER, runs)
    assert np.abs(plain - measured).max() > 1e-3 * np.abs(measured).max()


def told(block: str, law: dict[str, Any]) -> Part:
    """What the diagnosis says of a physical side with such a law and a little noise."""
    clean = simulated(having(block, "formula", **law), MOVES)
    noise = 1e-4 * np.std(clean, axis=0) * np.random.default_rng(5).standard_normal(clean.shape)
    seen = replace(EVIDENCE, measured=clean + noise, commands=MOVES)
    return physical_part(diagnose_physical(seen, PAPER, FIRST, lambda said: None))


@pytest.mark.parametrize(
    ("law", "on", "formula"),
    [(SCREW, ("command",), " * sin(2 * pi * u / 0.05"), (CREEP, ("t",), " * t")],
    ids=["screw", "creeps"],
)
def test_what_a_motor_does_beside_its_command_is_a_formula(
    law: dict[str, Any], on: tuple[str, ...], formula: str
) -> None:
    part = told("motor", law)
    (one,) = part.described
    assert (one.block, one.depends_on, one.unit) == ("motor", on, "m") and one.share > 0.999
    assert one.formula is not None and formula in one.formula
    assert float(one.formula.partition(" ")[0]) == pytest.approx(2e-3, rel=0.01)
    assert not part.physics and not part.unexplained
    assert [section["kind"] for section in part.effects] == ["formula"]
    assert max(fit.nrmse["explained"] / fit.nrmse["noise_floor"] for fit in part.fits) < 1.3


def test_what_a_wire_does_beside_its_spring_is_a_formula() -> None:
    part = told("wire", LIMP)
    (one,) = part.described
    assert (one.block, one.place, one.depends_on) == ("wire", "a1", ("x", "u"))
    assert one.formula is not None and "max(" in one.formula and one.held_out_gain > 0.99
    assert not part.physics and not part.unexplained
    assert max(fit.nrmse["explained"] / fit.nrmse["noise_floor"] for fit in part.fits) < 1.3
