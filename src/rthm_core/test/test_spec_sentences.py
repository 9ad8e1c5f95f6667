"""Every bad spec gets one sentence: the key, the value, what is allowed, the way out."""

from __future__ import annotations

from pathlib import Path

import pytest

from rthm_core.errors import InputError
from rthm_core.spec import read_spec, shipped_spec, shipped_text

PAPER = shipped_text("paper") + "    limits: {command: 1.0}\n"
LIMITS = (
    "command, rate, force, stale, ramp, on_abort, start, age, command_age, step, frozen, hold, heartbeat, "
    "position, velocity, measured_force, following, clock"
)
GUIDE = '    effects: ["guide"]\n    guide: {block: plant, kind: coulomb_friction, dof: x1, force: 0.05}\n'

CHANGES = [
    # old text, new text, the sentence
    (
        "mass: [1.2]",
        "mas: [1.2]",
        "plant.mas (given as [1.2]) is not a key of the spec, which knows dofs, mass, "
        "damping, stiffness, initial_position, initial_velocity there; write mass.",
    ),
    (
        "mass: [1.2]",
        "",
        "plant.mass is missing, but must be given: mass matrix M, symmetric and positive "
        "definite, a list of finite numbers; add plant.mass.",
    ),
    (
        "mass: [1.2]",
        "mass: 1.2",
        "plant.mass is 1.2, but must be a list of finite numbers; write it in brackets, [1.2].",
    ),
    (
        "mass: [1.2]",
        "mass: [1.2, 1.3]",
        "plant.mass is [1.2, 1.3], but must be a list of 1 x 1 numbers, row by row; give 1 instead of 2.",
    ),
    (
        "mass: [1.2]",
        "mass: [-1.2]",
        "plant.mass is [-1.2], but must be a symmetric, positive definite matrix; correct it.",
    ),
    (
        "mass: [1.2]",
        "mass: [.nan]",
        "plant.mass[0] is '.nan', but must be a finite number in kg; correct it.",
    ),
    (
        "mass: [1.2]",
        "mass: [1e999]",
        "plant.mass[0] is inf, but must be a finite number in kg; correct it.",
    ),
    (
        "mass: [1.2]",
        "mass: [1.0e300]",
        "plant.mass[0] is 1e+300, but must be a finite number in kg of a size up to 1e+12; correct it.",
    ),
    (
        "mass: [1.2]",
        "mass: [yes]",
        "plant.mass[0] is True, but must be a finite number in kg; correct it.",
    ),
    (
        "mass: [1.2]",
        "mass: []",
        "plant.mass is [], but must be a list of 1 x 1 numbers, row by row; give 1 instead of 0.",
    ),
    (
        "mass: [1.2]",
        "mass:",
        "plant.mass is empty, but must be a value; give one, or remove the key.",
    ),
    (
        "mass: [1.2]",
        "mass: [1.2]\n      mass: [1.3]",
        "plant.mass is there twice, again at line 8, but must be there once; remove one.",
    ),
    (
        "mass: [1.2]",
        "mass: {a: [1.2]}",
        "plant.mass is {'a': [1.2]}, but must be a list of finite numbers; correct it.",
    ),
    (
        "mass: [1.2]",
        "mass: &m [1.2]\n      damping: *m",
        "line 8 has an alias (*name), which ROS cannot read; write the values out.",
    ),
    (
        'dofs: ["x1"]',
        "dofs: [x1, x1]",
        "plant.dofs[1] is 'x1', but must be a name that is used once; rename one of the two.",
    ),
    (
        'dofs: ["x1"]',
        "dofs: [y]",
        "plant.dofs[0] is True, but must be text of 1 to 200 printable characters; put it in quotes.",
    ),
    (
        'dofs: ["x1"]',
        'dofs: ["x2"]',
        "numerical.dofs[0] is 'x2', but must be a name that no other dof or actuator has; rename it.",
    ),
    (
        'plant_dof: ["x1"]',
        'plant_dof: ["x11"]',
        "interface.plant_dof[0] is 'x11', but must be one of x1; write x1.",
    ),
    (
        'numerical_dof: ["x2"]',
        'numerical_dof: ["x1"]',
        "interface.numerical_dof[0] is 'x1', but must be one of x2; correct it.",
    ),
    (
        "stiffness: [40.0]",
        "stiffness: [0.0]",
        "actuator.stiffness[0] is 0.0, but must be a finite number above 0 in N/m; correct it.",
    ),
    (
        "stiffness: [40.0]",
        "",
        "actuator.stiffness is missing, but must be given; add actuator.stiffness (k_tot) or "
        "actuator.transmission.",
    ),
    (
        "stiffness: [40.0]",
        "stiffness: [4, 5]",
        "actuator.stiffness is [4.0, 5.0], but must be a list with one number for each of 1 "
        "actuator(s); give 1 instead of 2.",
    ),
    (
        "pretension: [0.0]",
        "pretension: [-1]",
        "actuator.pretension[0] is -1, but must be a finite number at least 0 in N; correct it.",
    ),
    (
        'compensator: "none"',
        "compensator: tailor",
        "actuator.compensator is 'tailor', but must be one of none, taylor, polynomial, ats, "
        "model, inverse, passivity; write taylor.",
    ),
    (
        'compensator: "none"',
        "motor_poles: [400]",
        "actuator.motor_poles is [400], but must be a list of 2 finite numbers, each above "
        "0; give 2 numbers, not 1.",
    ),
    (
        "td1: 0.0012",
        "td1: -0.0012",
        "timing.td1 is -0.0012, but must be a finite number at least 1e-06 and at most 3600 "
        "in s; correct it.",
    ),
    (
        "td2: 0.012",
        "td2: 0",
        "timing.td2 is 0, but must be a finite number at least 1e-06 and at most 3600 in s; correct it.",
    ),
    (
        "td4: 0.0",
        "td4: -1e-3",
        "timing.td4 is -0.001, but must be a finite number at least 0 and at most 3600 in s; correct it.",
    ),
    (
        "tau3: 0.012",
        "tau3: -0.012",
        "timing.tau3 is -0.012, but must be a finite number at least 0 and at most 3600 in s; correct it.",
    ),
    (
        "tau3: 0.012, ",
        "",
        "timing.tau3 is missing, but must be given: delay of the force reference to the "
        "controller, a finite number at least 0 and at most 3600 in s; add timing.tau3.",
    ),
    (
        "limits: {command: 1.0}",
        "limits: {comand: 1.0}",
        f"limits.comand (given as 1.0) is not a key of the spec, which knows {LIMITS} there; write command.",
    ),
    (
        "limits: {command: 1.0}",
        "limits: 1.0",
        f"limits is 1.0, but must be a section with {LIMITS}; correct it.",
    ),
    (
        "limits: {command: 1.0}",
        "noise: {seed: 1.5}",
        "noise.seed is 1.5, but must be a whole number from 0 to 9007199254740992; correct it.",
    ),
    (
        "limits: {command: 1.0}",
        "uncertainty: {plant: {mass: -0.1}}",
        "uncertainty.plant.mass is -0.1, but must be a finite number at least 0 and at most 100; correct it.",
    ),
    (
        "limits: {command: 1.0}",
        "load: {plant: {dof: x9, kind: none}}",
        "load.plant.dof is 'x9', but must be one of x1; correct it.",
    ),
    (
        "limits: {command: 1.0}",
        "load: {plant: {kind: sine}}",
        "load.plant.kind is 'sine', but must be one of none, constant, harmonic, multisine, "
        "file; correct it.",
    ),
    (
        "limits: {command: 1.0}",
        "load: {plant: {kind: constant}}",
        "load.plant.force is missing, but must be given: the force, a finite number in N; "
        "add load.plant.force.",
    ),
    (
        "limits: {command: 1.0}",
        "load: {plant: {kind: none, force: 1}}",
        "load.plant.force (given as 1) is not a key of the spec, which knows dof, kind there; remove it.",
    ),
    (
        "limits: {command: 1.0}",
        "limmits: {command: 1.0}",
        "limmits (given as {'command': 1.0}) is not a key of the spec, which knows plant, "
        "numerical, interface, actuator, timing, load, noise, uncertainty, limits, zero, "
        "effects_from, effects there; write limits.",
    ),
]

EFFECTS = [
    (
        '["guide"]',
        '["gide"]',
        "effects is missing, but must be a list with guide, which has a section; add it to the list.",
    ),
    (
        '["guide"]',
        '["guide", "band"]',
        "band is missing, but must be a section with block, kind, its place and its "
        "parameters; add it, or take band out of effects.",
    ),
    (
        '["guide"]',
        '["guide", "guide"]',
        "effects is 'guide', but must be a name that is used once; list each effect once.",
    ),
    (
        '["guide"]',
        '["plant"]',
        "effects is 'plant', but must be names of letters, digits and _ that are no section "
        "of the spec; rename the effect.",
    ),
    (
        '["guide"]',
        "guide",
        "effects is 'guide', but must be a list of names, each with a section of that name; correct it.",
    ),
    (
        "block: plant",
        "block: plan",
        "guide.block is 'plan', but must be one of plant, wire, motor, numerical, "
        "controller, link.tau1, link.tau2, link.tau3, link.tau4, sensor.position, "
        "sensor.velocity, sensor.acceleration, sensor.force; write plant.",
    ),
    (
        "block: plant, ",
        "",
        "guide.block is missing, but must be given; add guide.block.",
    ),
    (
        "dof: x1",
        "dof: x2",
        "guide.dof is 'x2', but must be one of x1; say which dof.",
    ),
    (
        "dof: x1",
        "actuator: a1",
        "guide.actuator is 'a1', but must be left out, as plant has no actuator; remove actuator.",
    ),
    (
        "force: 0.05",
        "force: -0.05",
        "guide.force is -0.05, but must be a finite number at least 0 in N; correct it.",
    ),
    (
        "force: 0.05",
        "forse: 0.05",
        "guide.forse is 0.05, but must be left out, as coulomb_friction of plant has only "
        "force; write force.",
    ),
    (
        ", force: 0.05",
        "",
        "guide.force is missing, but must be given: friction force; add force.",
    ),
    (
        "block: plant, kind: coulomb_friction, dof: x1, force: 0.05",
        "block: controller, kind: wrong_parameter, name: actuator.compensator, value: 1",
        "guide.name is 'actuator.compensator', but must be a number that controller computes with",
    ),
    (
        "block: plant, kind: coulomb_friction, dof: x1, force: 0.05",
        "block: controller, kind: wrong_parameter, name: actuator.stiffness, value: -1",
        "guide.value is -1.0, but must be above 0, as actuator.stiffness; correct it.",
    ),
]

TEXTS = [
    (
        "",
        "the spec is empty; give a ROS parameter file, or a shipped spec's name.",
    ),
    (
        " \n",
        "the spec is empty; give a ROS parameter file, or a shipped spec's name.",
    ),
    (
        "# nothing\n",
        "the spec is empty; give a ROS parameter file, or a shipped spec's name.",
    ),
    (
        "- 1\n",
        "the text is YAML but no ROS parameter file, which begins /**: ros__parameters:; wrap it so.",
    ),
    (
        "a: [1\n",
        "the text is not YAML at line 2 (expected ',' or ']', but got '<stream end>'); "
        "correct it, or give the path of a spec.",
    ),
    (
        "/**:\n  ros__parameters: {}\n",
        "the spec has no entries under ros__parameters; at least a section plant is needed.",
    ),
    (
        "plant: {mass: [1]}\n",
        "mass is [1], but must be a section with ros__parameters; put the sections under "
        "/**: ros__parameters:.",
    ),
    (
        "a: {}\n",
        "the text has no ros__parameters, but a spec is a ROS parameter file; put the "
        "sections under /**: ros__parameters:.",
    ),
    (
        "/**:\n  ros__parameters: {noise: {force: 1}}\n",
        "plant is missing, but must be given; add plant.",
    ),
    (
        "[" * 3000 + "\n",
        "the text is nested too deeply for a spec; give the text of a ROS parameter file.",
    ),
]


def sentence(text: str) -> str:
    with pytest.raises(InputError) as refused:
        read_spec(text)
    return str(refused.value)


@pytest.mark.parametrize(("old", "new", "told"), CHANGES, ids=[new[:30] for _, new, _ in CHANGES])
def test_a_bad_entry_is_told(old: str, new: str, told: str) -> None:
    assert old in PAPER
    assert sentence(PAPER.replace(old, new, 1)) == told


@pytest.mark.parametrize(("old", "new", "told"), EFFECTS, ids=[new[:30] for _, new, _ in EFFECTS])
def test_a_bad_effect_is_told(old: str, new: str, told: str) -> None:
    assert old in GUIDE
    assert sentence(PAPER + GUIDE.replace(old, new, 1)).startswith(told)


@pytest.mark.parametrize(("text", "told"), TEXTS, ids=range(len(TEXTS)))
def test_a_text_that_is_no_spec_is_told(text: str, told: str) -> None:
    assert sentence(text) == told


@pytest.mark.parametrize("missing", ["numerical", "interface", "actuator", "timing"])
def test_a_loop_without_one_of_its_sections_is_told(missing: str) -> None:
    lines = PAPER.splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith(f"    {missing}:"))
    end = next(i for i, line in enumerate(lines) if i > begin and line[4:5].strip())
    told = sentence("\n".join(lines[:begin] + lines[end:]))
    assert told.startswith(f"{missing} is missing, but must be given, as a loop needs plant, numerical, ")
    assert f"; add {missing}, or remove " in told


def test_an_unknown_kind_is_told_with_the_kinds_that_the_block_knows() -> None:
    told = sentence(PAPER + GUIDE.replace("coulomb_friction", "coulomb"))
    assert told.startswith("guide.kind is 'coulomb', but must be a kind that plant knows (bouc_wen, ")
    assert told.endswith("; write coulomb_friction.")


def test_an_asymmetric_mass_matrix_is_told() -> None:
    text = shipped_text("three_mass")
    assert "a symmetric, positive definite matrix" in sentence(text.replace("1.2, 0.0, 0.0", "1.2, 0.1, 0.0"))


def test_an_effect_of_the_loop_needs_a_loop() -> None:
    lossy = "    effects: [a]\n    a: {block: link.tau1, kind: loss, fraction: 0.1}\n"
    told = "a.block is 'link.tau1', but must be plant or a sensor of it, as the spec describes a plant alone;"
    assert sentence(shipped_text("decay") + lossy).startswith(told)


def test_a_path_that_leads_to_no_spec_is_told(tmp_path: Path) -> None:
    binary, large = tmp_path / "binary.yaml", tmp_path / "large.yaml"
    binary.write_bytes(bytes(range(256)))
    large.write_bytes(b"#" * 5_000_000)
    for path, told in (
        (
            tmp_path / "none.yaml",
            "there is no such file; give the path of a spec, or a shipped one's name: they are decay, "
            "friction, paper, paper_noisy, paper_printed, three_mass, transmission.",
        ),
        (
            tmp_path / "papr",
            "there is no such file; give the path of a spec, or a shipped one's name: paper is one.",
        ),
        (tmp_path, "this is a folder, but must be a spec file; name the file in it."),
        (Path("/dev/zero"), "this is not an ordinary file of at most 4 MB; give the path of a spec."),
        (large, "this is not an ordinary file of at most 4 MB; give the path of a spec."),
        (binary, "this is not text in UTF-8, but must be a YAML file; give the path of a spec."),
    ):
        assert sentence(str(path)) == f"{path}: {told}"


def test_a_bad_entry_of_a_file_is_told_with_the_path(tmp_path: Path) -> None:
    file = tmp_path / "spec.yaml"
    file.write_text(PAPER.replace("mass: [1.2]", "mass: [a]"))
    assert sentence(str(file)).startswith(f"{file}: plant.mass[0] is 'a', but must be a finite number in kg")


def test_an_unknown_shipped_spec_is_told_with_those_there_are() -> None:
    with pytest.raises(InputError, match=r"no shipped spec 'papper', only decay, .*; write paper\."):
        shipped_spec("papper")
    with pytest.raises(InputError, match=r"no shipped spec 'zzz', only decay, .*; use one of them\."):
        shipped_spec("zzz")
