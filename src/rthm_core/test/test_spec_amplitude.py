"""A test with smaller motion."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.spec import apply, scaled_motion, shipped_spec

PAPER = shipped_spec()


def test_a_linear_loop_moves_so_much_less() -> None:
    whole = apply(PAPER, {"load.numerical": {"dof": "x2", "kind": "constant", "force": 2.0}})
    moved, small = (simulate(spec, 2.0).plant_position for spec in (whole, scaled_motion(whole, 0.1)))
    np.testing.assert_allclose(small, 0.1 * np.asarray(moved), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("load", "name"),
    [
        ({"kind": "constant", "force": 2.0}, "force"),
        ({"kind": "harmonic", "amplitude": 2.0, "frequency": 3.0}, "amplitude"),
        ({"kind": "multisine", "rms": 2.0, "low": 1.0, "high": 9.0, "count": 5}, "rms"),
    ],
)
def test_every_kind_of_load_is_scaled(load: dict[str, object], name: str) -> None:
    whole = apply(PAPER, {"load.plant": {"dof": "x1"} | load})
    scaled = scaled_motion(whole, 0.25)
    assert getattr(scaled.load.plant, name) == 0.5
    assert apply(scaled, {f"load.plant.{name}": 2.0, "plant.initial_position": [0.5]}) == whole


def test_the_whole_test_is_the_spec_itself() -> None:
    assert scaled_motion(PAPER, 1.0) is PAPER


@pytest.mark.parametrize("amplitude", [0.0, -1.0, float("nan"), float("inf")])
def test_an_amplitude_that_is_no_size_is_refused(amplitude: float) -> None:
    with pytest.raises(InputError, match=r"--amplitude is .* but must be a number above 0"):
        scaled_motion(PAPER, amplitude)


def test_a_load_of_a_file_is_refused() -> None:
    whole = apply(PAPER, {"load.plant": {"dof": "x1", "kind": "file", "path": "/forces.csv"}})
    with pytest.raises(InputError, match=r"load.plant is a file, which --amplitude cannot scale"):
        scaled_motion(whole, 0.1)
