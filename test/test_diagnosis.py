"""The diagnosis of concealed cases: a small part of the table of ``benchmarks/concealed``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from benchmarks.concealed.case import Case, make_case
from typer.testing import CliRunner

from rthm_bringup.cli.main import application
from rthm_core.spec import read_spec

SHARED = Path(__file__).parents[2] / "shared" / "recordings"


def diagnosed(case: Case, *more: str) -> dict:
    words = ["diagnose", str(case.bag), "--spec", str(case.spec), "--json", "-", *more]
    done = CliRunner().invoke(application(), words)
    assert done.exit_code in (0, 1), done.output
    return json.loads(done.stdout)


def test_nothing_is_found_where_nothing_is_missing(tmp_path: Path) -> None:
    said = diagnosed(make_case(71, (), 0.05, tmp_path, duration=20.0))
    assert said["verdict"] == "match"
    assert not said["physics"] and not said["located"]
    assert 0.0 < said["detection_limits"]["plant.coulomb_friction.force"]["value"] < 0.05


def test_dry_friction_is_found_sized_and_written_into_the_spec(tmp_path: Path) -> None:
    case = make_case(72, (("plant", "coulomb_friction"),), 0.05, tmp_path, duration=20.0)
    patched = tmp_path / "patched.yaml"
    said = diagnosed(case, "--patched", str(patched))
    assert said["verdict"] == "explained" and said["located"] == ["plant"]
    (found,) = said["physics"]
    true = next(iter(case.truth["spec"]["effects"]))
    force = found["parameters"]["force"]
    assert found["kind"] == "coulomb_friction" and found["energy"] < 0.0
    assert abs(force["value"] - case.truth["spec"][true]["force"]) < 4.0 * force["std"]
    fit, *_ = said["fits"]
    assert fit["nrmse"]["explained"] < 1.2 * fit["nrmse"]["noise_floor"] < fit["nrmse"]["retuned"]
    (effect,) = read_spec(str(patched)).effects
    assert effect.parameters["force"] == pytest.approx(force["value"])


def test_a_wrong_mass_is_retuned_and_not_called_physics(tmp_path: Path) -> None:
    case = make_case(73, (), 0.05, tmp_path, retune="mass", duration=20.0)
    said = diagnosed(case)
    assert said["verdict"] == "retuned" and not said["physics"]
    mass = said["retuned"]["plant.mass"]
    assert abs(mass["value"] - case.truth["spec"]["plant"]["mass"][0]) < 4.0 * mass["std"]


def test_a_plant_that_gets_out_of_step_with_its_spec_is_retuned_and_not_called_physics(
    tmp_path: Path,
) -> None:
    case = make_case(1772449165606946996, (), 0.02, tmp_path, retune="drawn", duration=60.0)
    said = diagnosed(case)
    assert said["verdict"] == "retuned" and not said["physics"]
    true = case.truth["spec"]["plant"]
    for name in ("mass", "damping", "stiffness"):
        found = said["retuned"][f"plant.{name}"]
        assert abs(found["value"] - true[name][0]) < 4.0 * found["std"]


MISSED_ONCE = [
    (("link.tau3", "extra_delay"), 2127483687741567034, 0.02, "drawn"),  # retuning could get stuck
    (("link.tau4", "clock_offset"), 4215217393901162190, 0.15, ""),  # by more than half a period
]
TAKE_LONG = [
    (("motor", "rate_limit"), 3769535811400870209, 0.05, ""),  # arrives between two points of the grid
    (("wire", "slack"), 1286679092002342773, 0.05, ""),  # wrong models do not get near
    (("plant", "stribeck_friction"), 1096960604568808605, 0.15, ""),  # most of it is plain dry friction
    (("plant", "hidden_mode"), 1478158351231339146, 0.05, ""),  # others fit better at first
    (("plant", "hidden_mode"), 1702937212857128487, 0.15, ""),  # an imitation needed a companion
    (("sensor.force", "lag"), 513070866052298038, 0.15, ""),  # the force jumps between samples
]


@pytest.mark.parametrize(
    ("hidden", "seed", "size", "retune"),
    [*MISSED_ONCE, *(pytest.param(*case, marks=pytest.mark.long) for case in TAKE_LONG)],
)
def test_one_effect_is_all_that_is_named(
    hidden: tuple[str, str], seed: int, size: float, retune: str, tmp_path: Path
) -> None:
    said = diagnosed(make_case(seed, (hidden,), size, tmp_path, retune=retune, duration=60.0))
    assert [(one["block"], one["kind"]) for one in said["physics"]] == [hidden]


@pytest.mark.long
def test_dry_friction_beside_a_cubic_spring_is_not_taken_for_that_of_stribeck(tmp_path: Path) -> None:
    hidden = ("plant", "coulomb_friction"), ("plant", "cubic_stiffness")
    said = diagnosed(make_case(429167044748308444, hidden, 0.05, tmp_path, duration=60.0))
    assert {(one["block"], one["kind"]) for one in said["physics"]} == set(hidden)
    assert all(other["distinguishable"] for other in said["alternatives"])


@pytest.mark.long
def test_a_motor_of_second_order_that_is_quick_is_not_called_a_delay(tmp_path: Path) -> None:
    case = make_case(3945819810880683029, (("motor", "second_order"),), 0.02, tmp_path, duration=30.0)
    said = diagnosed(case)
    assert [(one["block"], one["kind"]) for one in said["physics"]] == [("motor", "second_order")]


@pytest.mark.skipif(not SHARED.is_dir(), reason="the measured recordings are not here")
@pytest.mark.parametrize(
    ("name", "verdict", "kinds"),
    [  # the axis is simulated to 3.6 of its noise and no nearer
        pytest.param(
            "emps_identification", "improved", {"coulomb_friction", "constant_load"}, marks=pytest.mark.long
        ),
        pytest.param("hysteresis_multisine", "explained", {"bouc_wen"}, marks=pytest.mark.long),
    ],
)
def test_measured_recordings_show_the_physics_that_is_known_to_be_in_them(
    name: str, verdict: str, kinds: set[str]
) -> None:
    words = ["diagnose", str(SHARED / name), "--spec", str(SHARED / f"{name}.yaml"), "--json", "-"]
    said = json.loads(CliRunner().invoke(application(), words).stdout)
    found = {one["kind"]: one["parameters"] for one in said["physics"]}
    assert said["verdict"] == verdict and kinds <= set(found)
    if "coulomb_friction" in found:
        assert abs(found["coulomb_friction"]["force"]["value"] - 20.3) < 1.0
