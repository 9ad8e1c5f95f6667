from __future__ import annotations

import array

import pytest

from rthm_core.errors import InputError
from rthm_core.ros.parameters import OWN
from rthm_core.spec import (
    NODE_PARAMETERS,
    numbers,
    parameters,
    read_spec,
    shipped_names,
    shipped_spec,
    shipped_text,
    spec_from_parameters,
)

PAPER = shipped_spec("paper")
TYPES = {"double": float, "integer": int, "string": str, "double_array": list, "string_array": list}


@pytest.mark.parametrize("name", shipped_names())
def test_every_parameter_has_the_value_of_its_type_within_its_bounds(name: str) -> None:
    for one in parameters(shipped_spec(name)):
        assert type(one.value) is TYPES[one.type]
        assert one.value != []
        assert one.description
        values = one.value if isinstance(one.value, list) else [one.value]
        for value in values:
            assert type(value) is (float if "double" in one.type else int if one.type == "integer" else str)
            assert isinstance(value, str) or one.minimum is None or value >= one.minimum
            assert isinstance(value, str) or one.maximum is None or value <= one.maximum


def test_a_parameter_carries_what_a_ros_descriptor_needs() -> None:
    (period,) = (one for one in parameters(PAPER) if one.name == "timing.td1")
    assert (period.value, period.type, period.unit) == (0.0012, "double", "s")
    assert (period.minimum, period.maximum) == (1e-6, 3600.0)
    assert period.description == "period Td1 of the data acquisition"
    (force,) = (one for one in parameters(shipped_spec("friction")) if one.name == "guide.force")
    assert (force.value, force.unit, force.minimum, force.maximum) == (0.05, "N", 0.0, None)


def test_parameters_keep_the_order_of_the_schema() -> None:
    names = [one.name for one in parameters(shipped_spec("friction"))]
    assert names[:3] == ["plant.dofs", "plant.mass", "plant.damping"]
    assert names[-5:] == ["effects", "guide.block", "guide.kind", "guide.dof", "guide.force"]


def test_values_may_be_arrays_as_ros_messages_have_them() -> None:
    given = {one.name: one.value for one in parameters(PAPER)}
    given["plant.mass"] = array.array("d", [2.0])  # type: ignore[assignment]
    assert spec_from_parameters(given).plant.mass == (2.0,)


def test_a_nodes_own_parameters_are_passed_over_when_named() -> None:
    given = {one.name: one.value for one in parameters(PAPER)} | {"priority": 50}
    assert spec_from_parameters(given, besides=["priority"]) == PAPER
    with pytest.raises(InputError, match=r"priority \(given as 50\) is not a key of the spec"):
        spec_from_parameters(given)


def test_a_spec_file_may_hold_the_parameters_of_our_nodes() -> None:
    assert set(OWN) <= NODE_PARAMETERS
    text = shipped_text("paper") + "".join(f"    {name}: 1\n" for name in OWN)
    assert read_spec(text) == PAPER


def test_every_number_can_be_named_by_its_element() -> None:
    found = numbers(shipped_spec("three_mass"))
    assert {"plant.mass[8]", "actuator.stiffness[1]", "timing.tau1", "noise.force"} <= set(found)
    assert "plant.mass" not in found
    assert found["actuator.stiffness[0]"].unit == "N/m"
    assert "actuator.stiffness" in numbers(shipped_spec("transmission"))
