from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rthm_core.errors import InputError
from rthm_core.spec import apply, shipped_spec

PAPER = shipped_spec("paper")


def test_a_change_by_dotted_name_gives_another_spec_and_keeps_the_first() -> None:
    changes = {"timing.tau1": 0.005, "plant.mass": [2], "plant.stiffness[0]": "1e1", "noise.seed": 3}
    changed = apply(PAPER, changes)
    assert changed.timing is not None
    assert PAPER.timing is not None
    assert (changed.timing.tau1, changed.plant.mass, changed.plant.stiffness) == (0.005, (2.0,), (10.0,))
    assert changed.noise.seed == 3
    assert (PAPER.timing.tau1, PAPER.plant.mass) == (0.004, (1.2,))


def test_sections_in_which_nothing_changes_stay_the_same_objects() -> None:
    friction = shipped_spec("friction")
    changed = apply(friction, {"plant.mass": 2.0})
    assert changed.timing is friction.timing and changed.effects[0] is friction.effects[0]
    assert changed.plant is not friction.plant
    stronger = apply(friction, {"guide.force": 0.1})
    assert stronger.plant is friction.plant and stronger.effects[0] is not friction.effects[0]


def test_numbers_of_numpy_are_numbers() -> None:
    changed = apply(PAPER, {"plant.mass": np.array([2.0]), "noise.seed": np.int64(3)})
    assert changed.plant.mass == apply(PAPER, {"plant.mass": np.float32(2.0)}).plant.mass == (2.0,)
    assert changed.noise.seed == 3


def test_a_list_of_one_may_be_given_as_its_number() -> None:
    assert apply(PAPER, {"plant.mass": 2.0}).plant.mass == (2.0,)
    with pytest.raises(InputError, match=r"plant\.mass is 2\.0, but must be a list"):
        apply(shipped_spec("three_mass"), {"plant.mass": 2.0})


def test_sections_can_be_added_and_taken_out() -> None:
    limited = apply(PAPER, {"limits": {"command": 1.0, "ramp": 2}})
    assert limited.limits is not None
    assert limited.limits.ramp == 2.0
    assert apply(limited, {"limits": None}) == PAPER


def test_a_new_kind_of_load_forgets_the_entries_of_the_old_one() -> None:
    harmonic = apply(PAPER, {"load.plant": {"kind": "harmonic", "amplitude": 1, "frequency": 2}})
    constant = apply(harmonic, {"load.plant.force": 3, "load.plant.kind": "constant"})
    assert constant.load.plant is not None
    assert constant.load.plant.model_dump() == {"dof": "x1", "kind": "constant", "force": 3.0}


def test_effects_can_be_added_changed_and_taken_out() -> None:
    guide = {"block": "plant", "kind": "coulomb_friction", "force": 0.05}
    rubbing = apply(PAPER, {"effects": ["guide"], "guide": guide})
    assert rubbing == shipped_spec("friction")
    assert apply(rubbing, {"guide.force": 0.1}).effects[0].parameters == {"force": 0.1}
    drag = apply(rubbing, {"guide.kind": "quadratic_drag", "guide.coefficient": 2.0}).effects[0]
    assert (drag.kind, drag.dof, drag.parameters) == ("quadratic_drag", "x1", {"coefficient": 2.0})
    assert apply(rubbing, {"effects": []}) == PAPER


def test_a_stiffness_of_the_actuator_takes_the_place_of_a_transmission() -> None:
    changed = apply(shipped_spec("transmission"), {"actuator.stiffness[0]": 50})
    assert changed.k_tot == (50.0,)
    assert changed.actuator is not None
    assert changed.actuator.transmission is None


def test_scaled_timing_scales_every_period_and_delay() -> None:
    scaled = PAPER.scaled_timing(2.0)
    assert scaled.timing is not None
    assert PAPER.timing is not None
    assert dict(scaled.timing.items()) == {name: 2.0 * value for name, value in PAPER.timing.items()}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"timing.tau5": 1}, "timing.tau5 (given as 1) is not a key of the spec"),
        (
            {"plant.mass[1]": 1},
            "plant.mass[1] is 1, but must be an element that there is",
        ),
        (
            {"plant.mas[0]": 1},
            "plant.mas[0] is 1, but must be an element that there is",
        ),
        ({"plant.mass": -1}, "plant.mass is [-1.0], but must be a symmetric, positive definite matrix"),
        ({"timing": None}, "timing is missing, but must be given"),
        ({"guide.force": 1}, "guide (given as {'force': 1}) is not a key of the spec"),
    ],
)
def test_a_change_that_makes_no_sense_is_told(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError) as refused:
        apply(PAPER, changes)
    assert str(refused.value).startswith(told)
