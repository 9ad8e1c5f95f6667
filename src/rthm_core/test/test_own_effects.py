"""What a file of a user's declares is simulated, and the file is executed only where it is named."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rthm_core.effects import effect, kinds, load_effects, own, registry
from rthm_core.engine import Trajectory, simulate
from rthm_core.errors import InputError
from rthm_core.spec import apply, read_spec, shipped_spec, spec_at, write_spec

LAW = """
from rthm_core.effects import EffectParameter, PlantLaw, register

@register
class Mine(PlantLaw):
    kind, blocks = "mine", ("plant",)
    parameters = {"gain": EffectParameter("N/m^3", "force per cubed displacement")}
    words = "a force of my own acts on {dof}"

    @staticmethod
    def force(x, v, z, t, p, mode):
        return -p[0] * x * x * x
"""
COPY = """
from rthm_core.effects import effect, register

@register
class Copied(effect({kind!r}, {block!r})):
    kind, blocks = "copied", ({block!r},)
"""
MORE = """
    effects_from: ["{file}"]
    effects: ["one"]
    one: {{block: plant, kind: mine, gain: 3}}
"""
MARK = "open({mark!r}, 'w').close()\n"


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    """Forget what a test declares."""
    before = set(registry.declared())
    yield
    registry.forget(one for one in registry.declared() if one not in before)
    own._LOADED.clear()
    own.load_installed.cache_clear()


def file_in(folder: Path, text: str = LAW, name: str = "mine.py") -> Path:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def announced(monkeypatch: pytest.MonkeyPatch, module: str) -> None:
    """Have a module announced by an installed package."""
    point = EntryPoint("magnets", module, own.GROUP)
    monkeypatch.setattr(own, "entry_points", lambda group: [point])
    own.load_installed.cache_clear()


def rig(block: str, kind: str, place: str, **parameters: float) -> Trajectory:
    section = {"block": block, "kind": kind, "dof" if block == "plant" else "actuator": place, **parameters}
    spec = apply(shipped_spec("paper"), {"effects": ["one"], "one": section})
    return simulate(spec, 3.0, 0.01)


@pytest.mark.parametrize(
    ("block", "kind", "place", "parameters"),
    [
        ("plant", "cubic_stiffness", "x1", {"coefficient": 40.0}),
        ("plant", "coulomb_friction", "x1", {"force": 0.3}),
        ("plant", "stribeck_friction", "x1",
         {"coulomb_force": 0.2, "static_force": 0.3, "stribeck_velocity": 0.1}),
        ("plant", "maxwell_branch", "x1", {"stiffness": 5.0, "damping": 1.0}),
        ("plant", "end_stop", "x1", {"position": 0.2, "stiffness": 500.0, "damping": 1.0}),
        ("plant", "constant_load", "x1", {"force": 0.5}),
        ("plant", "mass_change", "x1", {"change": 0.4, "at": 1.0, "within": 0.5}),
        ("wire", "hardening", "a1", {"coefficient": 2000.0}),
        ("wire", "backlash", "a1", {"gap": 0.01}),
    ],
)  # fmt: skip
def test_a_copy_of_a_law_in_a_file_of_ones_own_moves_the_rig_as_the_law_does(
    block: str, kind: str, place: str, parameters: dict[str, float], tmp_path: Path
) -> None:
    load_effects([file_in(tmp_path, COPY.format(kind=kind, block=block), f"{kind}.py")])
    shipped, copied = rig(block, kind, place, **parameters), rig(block, "copied", place, **parameters)
    assert np.abs(copied.plant_position - shipped.plant_position).max() < 1e-9
    assert np.abs(copied.energies["E_effects"] - shipped.energies["E_effects"]).max() < 1e-9
    assert (
        np.abs(shipped.plant_position - simulate(shipped_spec("paper"), 3.0, 0.01).plant_position).max()
        > 1e-4
    )


def test_a_spec_file_brings_the_files_beside_it_and_what_is_written_names_them_by_their_full_path(
    tmp_path: Path,
) -> None:
    file = file_in(tmp_path)
    given = write_spec(shipped_spec("paper"))
    more = (
        '    effects_from: ["mine.py"]\n    effects: ["one"]\n    one: {block: plant, kind: mine, gain: 3}\n'
    )
    (tmp_path / "rig.yaml").write_text(given + more)
    spec = spec_at(tmp_path / "rig.yaml")
    assert spec.effects_from == (str(file),) and spec.effects[0].kind == "mine"
    assert read_spec(write_spec(spec)) == spec


def test_a_text_executes_nothing_and_says_which_file_it_wants(tmp_path: Path) -> None:
    mark = tmp_path / "executed"
    file = file_in(tmp_path, LAW + MARK.format(mark=str(mark)))
    text = write_spec(shipped_spec("paper"))
    text += MORE.format(file=file)
    with pytest.raises(InputError, match=r"one\.kind is 'mine', .* give --effects .*mine\.py"):
        read_spec(text)
    assert not mark.exists()
    load_effects([file])
    assert mark.exists() and read_spec(text).effects[0].kind == "mine"


def test_an_option_adds_its_file_in_place_of_one_of_the_same_name_elsewhere(
    tmp_path: Path,
) -> None:
    file = file_in(tmp_path)
    known = apply(shipped_spec("paper"), {"effects_from": ["/elsewhere/mine.py", "a.module"]})
    assert spec_at(known, [file]).effects_from == ("a.module", str(file))
    assert spec_at("paper", [file]).effects_from == (str(file),)
    assert spec_at("paper").effects_from == ()


def test_a_node_loads_the_file_that_its_parameters_name(tmp_path: Path) -> None:
    from rthm_core.ros.parameters import spec_of
    from rthm_core.spec import parameters

    file = file_in(tmp_path)
    given: dict[str, Any] = {one.name: one.value for one in parameters(shipped_spec("paper"))}
    given |= {"effects_from": [str(file)], "effects": ["one"]}
    given |= {"one.block": "plant", "one.kind": "mine", "one.gain": 3.0}
    node: Any = SimpleNamespace(
        _parameters={key: SimpleNamespace(value=value) for key, value in given.items()}
    )
    assert spec_of(node, ()).effects[0].kind == "mine"


def test_what_an_installed_package_announces_is_known_without_being_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file_in(tmp_path, LAW, "announced_mine.py")
    monkeypatch.syspath_prepend(tmp_path)
    announced(monkeypatch, "announced_mine")
    assert "mine" in kinds("plant") and effect("mine", "plant").kind == "mine"
    assert not any(one.kind == "mine" for one in registry.shipped("plant"))


def test_what_an_installed_package_announces_must_be_a_law_of_force(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file_in(tmp_path, LAW.replace('("plant",)', '("sensor",)'), "announced_sensor.py")
    monkeypatch.syspath_prepend(tmp_path)
    announced(monkeypatch, "announced_sensor")
    with pytest.raises(InputError, match=r"a package \(announced_sensor\) declares mine for sensor"):
        kinds("sensor.force")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("1 / 0\n", r"mine\.py cannot be loaded as effects \(ZeroDivisionError"),
        ("x = 1\n", r"mine\.py declares no kind of effect; decorate"),
        (LAW.replace('"mine"', '"cubic_stiffness"'), r"cubic_stiffness is declared twice for plant"),
        (LAW.replace('("plant",)', '("motor",)'), r"mine for motor, but effects of one's own are a PlantLaw"),
        (LAW.replace("{dof}", "{nothing}"), r"the words of mine use \['nothing'\]"),
    ],
)
def test_a_file_that_declares_nothing_to_compute_with_is_refused_and_leaves_nothing(
    text: str, sentence: str, tmp_path: Path
) -> None:
    before = registry.declared()
    with pytest.raises(InputError, match=sentence):
        load_effects([file_in(tmp_path, text)])
    assert registry.declared() == before


def test_a_file_that_is_not_there_or_was_changed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.py', which cannot be read"):
        load_effects([tmp_path / "nowhere.py"])
    file = file_in(tmp_path)
    assert load_effects([file]) == load_effects([file]) == (str(file),)
    file.write_text(LAW + "\n")
    with pytest.raises(InputError, match="was changed after it was loaded; start Python again"):
        load_effects([file])


def test_a_law_that_cannot_be_compiled_is_refused_with_the_reason(tmp_path: Path) -> None:
    load_effects([file_in(tmp_path, LAW.replace("-p[0] * x * x * x", "open(x)"))])
    with pytest.raises(InputError, match="the law mine cannot be compiled"):
        rig("plant", "mine", "x1", gain=1.0)
