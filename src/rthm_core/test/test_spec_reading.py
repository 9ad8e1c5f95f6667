from __future__ import annotations

from pathlib import Path

import pytest

from rthm_core.errors import InputError
from rthm_core.spec import read_spec, shipped_spec, shipped_text

PLANT = """/**:
  ros__parameters:
    plant: {dofs: [x1], mass: [1.2], damping: [0.05], stiffness: [12.0], initial_position: [0.5]}
"""


def plant(mass: str) -> str:
    return PLANT.replace("mass: [1.2]", f"mass: [{mass}]")


@pytest.mark.parametrize("text", ["2", "2.0", "+2", "2e0", "2E+0", "0.2e1", "20e-1", "'2'", "!!str 2", "2."])
def test_a_number_may_be_written_as_ros_or_as_yaml_wants_it(text: str) -> None:
    assert read_spec(plant(text)).plant.mass == (2.0,)


NO_NUMBERS = ["010", "0x10", "1:30", "1_000", "true", "y", "nan", ".inf", "-inf", "~", "1e400", ""]


@pytest.mark.parametrize("text", NO_NUMBERS)
def test_text_that_ros_and_yaml_read_differently_is_no_number(text: str) -> None:
    with pytest.raises(InputError, match=r"plant\.mass"):
        read_spec(plant(text))


def test_a_plant_alone_is_a_spec() -> None:
    spec = read_spec(PLANT)
    assert spec.plant.initial_velocity == (0.0,)
    assert spec.load.plant is not None
    assert (spec.load.plant.kind, spec.load.plant.dof) == ("none", "x1")
    assert not spec.is_loop
    assert spec.k_tot == ()
    with pytest.raises(InputError, match="a plant alone, but this needs a whole loop"):
        spec.loop()


def test_a_plant_may_say_when_it_is_sampled() -> None:
    text = PLANT + "    timing: {td1: 1e-3, td2: 1, td3: 1, td4: 0, tau1: 0, tau2: 0, tau3: 0, tau4: 0}\n"
    timing = read_spec(text).timing
    assert timing is not None
    assert timing.ns("td1") == 1_000_000


def test_what_may_be_absent_is_zero_or_nothing() -> None:
    text = shipped_text("paper").replace('      compensator: "none"\n', "")
    text = text.replace("      pretension: [0.0]", "#").replace("      initial_velocity: [0.0]", "#")
    text = text.replace("      initial_position: [0.0]", "#")
    assert read_spec(text) == shipped_spec("paper")


def test_dotted_names_and_sections_mean_the_same() -> None:
    assert read_spec(PLANT + "    noise.force: 0.02\n") == read_spec(PLANT + "    noise: {force: 0.02}\n")


def test_the_section_of_a_node_adds_to_that_for_all_nodes() -> None:
    assert read_spec(PLANT + "/rthm/plant:\n  ros__parameters: {noise: {force: 1}}\n").noise.force == 1.0
    assert read_spec(PLANT + "rthm:\n  plant:\n    ros__parameters: {noise: {force: 1}}\n").noise.force == 1.0
    assert read_spec(PLANT + "/**/plant:\n  ros__parameters: {noise.force: 1}\n").noise.force == 1.0


def test_sections_of_nodes_may_repeat_but_not_contradict_each_other() -> None:
    again = PLANT.replace("/**:", "/rthm/plant:")
    assert read_spec(PLANT + again) == read_spec(PLANT)
    with pytest.raises(InputError, match=r"plant\.mass is \[1\.2\], and \[1\.3\] for /rthm/plant"):
        read_spec(PLANT + again.replace("1.2", "1.3"))


def test_parameters_of_nodes_are_no_part_of_a_spec() -> None:
    extra = "    use_sim_time: false\n    duration: 20.0\n/camera:\n  ros__parameters: {exposure: 3}\n"
    assert read_spec(PLANT + extra) == read_spec(PLANT)


def test_an_effect_sits_at_the_only_dof_there_is() -> None:
    text = PLANT + "    effects: [guide]\n    guide: {block: plant, kind: coulomb_friction, force: 1}\n"
    assert read_spec(text).effects[0].dof == "x1"


def test_a_link_is_named_in_its_block_or_beside_it() -> None:
    lossy = "    effects: [late]\n    late: {block: link.tau1, kind: loss, fraction: 0.1}\n"
    named = shipped_text("paper") + lossy
    beside = named.replace("link.tau1", "link, link: tau1")
    assert read_spec(named) == read_spec(beside)
    assert read_spec(named).effects[0].link == "tau1"


def test_k_tot_follows_from_the_transmission_by_the_corrected_equation_5() -> None:
    by_hand = 1.0 / (1.0 / 80.0 + 0.05**2 / 2.0)
    assert shipped_spec("transmission").k_tot == pytest.approx((by_hand,), rel=1e-15)
    assert shipped_spec("paper").k_tot == (40.0,)


def test_a_file_and_its_text_are_the_same_spec(tmp_path: Path) -> None:
    file = tmp_path / "a: b.yaml"
    file.write_text("\ufeff" + PLANT, encoding="utf-8")
    assert read_spec(file) == read_spec(str(file)) == read_spec(PLANT)


def test_the_path_of_a_load_counts_from_the_folder_of_the_spec(tmp_path: Path) -> None:
    text = PLANT + "    load: {plant: {kind: file, path: loads/wave.csv}}\n"
    file = tmp_path / "spec.yaml"
    file.write_text(text)
    load = read_spec(file).load.plant
    assert load is not None
    assert load.kind == "file"
    assert load.path == str(tmp_path / "loads/wave.csv")
    from_text = read_spec(text).load.plant
    assert from_text is not None
    assert from_text.kind == "file"
    assert from_text.path == "loads/wave.csv"


def test_a_spec_does_not_change() -> None:
    with pytest.raises(ValueError, match="frozen"):
        shipped_spec("paper").plant.mass = (2.0,)  # type: ignore[misc]


def test_all_clocks_tick_together_once_a_hyperperiod() -> None:
    assert shipped_spec("paper").hyperperiod_ns == 12_000_000
    assert shipped_spec("three_mass").hyperperiod_ns == 8_000_000
