"""Motion in, force out: what the force of a component follows from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.component import Channels, ComponentTest, channels_of, component_test, identify_component
from rthm_analysis.component.along import force_along, substeps_for
from rthm_analysis.component.fitting import lagged
from rthm_analysis.component.motion import smooth_motion, smoothed
from rthm_analysis.component.words import lag_words, term_words
from rthm_analysis.diagnosis.replay.evidence import gather
from rthm_analysis.exchange import import_files, wanted
from rthm_analysis.recording import read_recording
from rthm_core.effects.registry import effect
from rthm_core.errors import InputError

from .plain import plant

T = np.arange(0.0, 16.0, 0.01)
X = 0.02 * np.sin(5.0 * T) + 0.01 * np.sin(1.9 * T + 0.3)
V = 0.1 * np.cos(5.0 * T) + 0.019 * np.cos(1.9 * T + 0.3)
VOLTAGE = 4.0 * (np.sin(0.9 * T) > 0.2) + 1.0
NAMES = Channels("x1", "a1", ("voltage",))


def bench(force: np.ndarray, noise: float, **inputs: np.ndarray) -> ComponentTest:
    measured = force + noise * np.random.default_rng(1).standard_normal(T.size)
    return ComponentTest("bench", T, X, V, measured, np.ones(T.size, dtype=bool), inputs)


def test_a_signal_keeps_its_values_and_rates_without_its_noise() -> None:
    found = smoothed(X + 1e-4 * np.random.default_rng(2).standard_normal(T.size))
    inner = slice(20, -20)
    assert np.std((found.values - X)[inner]) < 5e-5
    assert np.std((found.rates / 0.01 - V)[inner]) < 0.02 * np.std(V)
    assert found.noise == pytest.approx(1e-4, rel=0.1)


def test_a_position_is_found_from_a_velocity_alone() -> None:
    x, _ = smooth_motion(T, None, V)
    assert np.std(x - X) < 0.01 * np.std(X)


def test_what_does_not_move_is_refused() -> None:
    with pytest.raises(InputError, match="does not move"):
        smooth_motion(T, np.ones(T.size), None)


def test_the_force_of_a_law_along_a_motion_is_that_of_its_equation() -> None:
    friction = effect("coulomb_friction", "plant")
    assert np.array_equal(force_along(friction, (0.3,), X, V, T), -0.3 * np.where(V > 0.0, 1.0, -1.0))
    stop = effect("end_stop", "plant")
    p = [{"position": 0.01, "stiffness": 200.0}.get(name, 0.0) for name in stop.parameters]
    assert np.allclose(force_along(stop, p, X, V, T), -200.0 * np.maximum(X - 0.01, 0.0))


def test_a_law_that_remembers_takes_as_many_steps_as_it_needs() -> None:
    law, p = effect("bouc_wen", "plant"), (100.0, 1.0, 900.0, 600.0, 1.0)
    steps = substeps_for(law, p, X, V, T)
    force = force_along(law, p, X, V, T, steps)
    assert steps > 1
    assert np.allclose(force, force_along(law, p, X, V, T, 8 * steps), atol=2e-4 * np.abs(force).max())


def test_an_input_lags_as_a_first_order_filter_does() -> None:
    step = np.where(T < 1.0, 0.0, 1.0)
    late = lagged(step, 0.5, 0.01)
    assert np.allclose(late[T >= 1.5], 1.0 - np.exp(-(T[T >= 1.5] - 1.0) / 0.5), atol=0.012)
    assert np.array_equal(lagged(step, 0.0, 0.01), step)


def test_a_damper_is_told_with_its_voltage_and_lag() -> None:
    current = lagged(VOLTAGE, 0.05, 0.01)
    loop = force_along(effect("bouc_wen", "plant"), (100.0, 1.0, 240.0, 130.0, 1.0), X, V, T, 4)
    force = (20.0 + 6.0 * current) * V - (1.0 + 0.4 * current) * loop
    found, _ = identify_component([bench(force, 0.01 * np.std(force), voltage=VOLTAGE)], NAMES)
    assert found.verdict == "explained"
    assert found.depends_on == ("x", "v", "voltage")
    assert {term.kind for term in found.terms} == {"damping", "bouc_wen"}
    assert abs(found.lags["voltage"].value - 0.05) < 5e-3
    damping = next(term for term in found.terms if term.kind == "damping")
    for told, true in (
        (damping.parameters["damping"], 20.0),
        (damping.by_input["voltage"]["damping"], 6.0),
    ):
        assert abs(told.value - true) < max(4.0 * told.std, 0.05 * true)
    assert "x, v and voltage, and on what was before: a damper and Bouc-Wen hysteresis" in found.words
    assert term_words(damping).endswith("more for each unit of voltage")
    assert lag_words("voltage", found.lags["voltage"]).startswith("voltage: acts behind a lag of")


def test_an_input_that_does_nothing_is_not_told() -> None:
    found, _ = identify_component([bench(500.0 * X + 30.0 * V, 0.05, voltage=VOLTAGE)], NAMES)
    assert (found.verdict, found.depends_on) == ("explained", ("x", "v"))
    assert {term.kind: next(iter(term.parameters.values())).value for term in found.terms} == pytest.approx(
        {"stiffness": 500.0, "damping": 30.0}, rel=0.01
    )


def test_nothing_is_named_where_the_force_follows_from_nothing_that_was_recorded() -> None:
    force = 2.0 * np.random.default_rng(5).standard_normal(T.size).cumsum() / np.sqrt(T.size)
    found, _ = identify_component([bench(force, 0.001, voltage=VOLTAGE)], NAMES)
    assert (found.verdict, found.terms, found.depends_on) == ("unexplained", (), ())


def test_of_several_tests_the_last_confirms() -> None:
    one = bench(500.0 * X + 30.0 * V, 0.05)
    other = replace(one, name="other", force=one.force + 5.0)
    found, _ = identify_component([one, other], Channels("x1", "a1"))
    assert found.held_out == "other"
    assert found.errors.found > 50.0 * found.errors.noise


def write(path: Path, sign: float = 1.0) -> Path:
    force = sign * (500.0 * X + 30.0 * V)
    columns = np.stack([T, X, force, VOLTAGE], axis=1)
    np.savetxt(path, columns, "%.9g", ",", header="t [s],x [m],f [N],u [V]", comments="")
    return path


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_file_of_a_logger_becomes_a_test_of_a_component(tmp_path: Path, sign: float) -> None:
    said = wanted(["position:x1=x", "force:a1=f", "input:voltage=u"])
    bag = import_files([str(write(tmp_path / "damper.csv", sign))], tmp_path / "bag", said)[0]
    assert [(one.name, one.unit) for one in bag.channels] == [("x1", "m"), ("a1", "N"), ("voltage", "V")]
    recording = read_recording(bag.bag)
    channels = channels_of(recording)
    assert channels == NAMES and recording.plant.names == ("x1", "a1")  # a voltage is no force on a plant
    test = component_test(recording, channels)
    assert test.reversed == (sign < 0.0)
    assert np.allclose(test.force, 500.0 * X + 30.0 * V, atol=1e-6)
    assert np.allclose(test.inputs["voltage"], VOLTAGE)
    with pytest.raises(InputError, match="--input speed is no input of this recording, which has voltage"):
        channels_of(recording, inputs=["speed"])
    with pytest.raises(InputError, match="--motion is x2"):
        channels_of(recording, motion="x2")


def test_a_diagnosis_of_a_plant_takes_no_input_for_a_force(tmp_path: Path) -> None:
    said = wanted(["position:x1=x", "force:a1=f", "input:voltage=u"])
    bag = import_files([str(write(tmp_path / "damper.csv", 1.0))], tmp_path / "bag", said)[0].bag
    recording = read_recording(bag)
    seen = gather(recording, plant())
    assert np.array_equal(seen.load, recording.plant.columns("effort", ["a1"]))
    assert any(note.startswith("voltage is an input of a component") for note in seen.notes)
