"""Results have columns, a picture, a table, and go to other tools."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import rthm
from rthm.results import Result
from rthm.theory import Response
from rthm_core.spec import shipped_spec

OMEGA = np.geomspace(0.5, 20.0, 7)


@pytest.fixture(scope="module")
def results(rig: Path) -> dict[str, Any]:
    bag = rig / "rig" / "bag"
    return {
        "simulate": rthm.simulate("paper", 1.0),
        "sensitivities": rthm.sensitivities("paper", 1.0, ["plant.mass", "interface.stiffness"]),
        "simulate_many": rthm.simulate_many("paper", {"plant.mass": [1.1, 1.3]}, 1.0, sample=0.1),
        "read": rthm.read(bag),
        "energy": rthm.energy(bag),
        "timing": rthm.timing(bag),
        "stability": rthm.stability("paper", limits=False),
        "response": rthm.response("paper", OMEGA),
        "sweep": rthm.sweep("paper", {"timing.scale": "1:30:3"}, 0.0),
        "diagnose": rthm.diagnose(bag, "paper"),
    }


def test_every_result_has_columns_of_one_length_a_picture_and_a_page(results: dict[str, Any]) -> None:
    for name, found in results.items():
        assert isinstance(found, Result), name
        lengths = {one.values.shape for one in found.columns().values()}
        assert len(lengths) == 1 and len(lengths.pop()) == 1, name
        figure = found.plot()
        assert figure.axes and all(axis.has_data() for axis in figure.axes), name
        page = found._repr_html_()
        assert page.startswith("<table>") and page.count("<tr>") > 1, name


def test_an_imported_acceleration_is_a_column(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    table.write_text("t,y,a\n0,1,2\n0.1,2,4\n0.2,3,6\n")
    told = {"position:x1": "y", "acceleration:x1": "a"}
    found = rthm.import_table(table, tmp_path / "bag", told, units={"acceleration": "g"}).columns()
    assert list(found) == ["t", "x1.position", "x1.acceleration"]
    assert found["x1.acceleration"].unit == "m/s^2"
    assert found["x1.acceleration"].values == pytest.approx([19.6133, 39.2266, 58.8399])


def test_a_column_is_drawn_by_its_name_and_a_wrong_name_is_told_the_nearest(results: dict[str, Any]) -> None:
    run = results["simulate"]
    (axis,) = run.plot("x1.position", "x2.position").axes
    assert [line.get_label() for line in axis.lines] == ["x1.position", "x2.position"]
    assert axis.get_ylabel() == "m" and axis.get_xlabel() == "t, s"
    with pytest.raises(rthm.InputError, match=r"no column 'x1\.positon'; write x1\.position"):
        run.plot("x1.positon")


def test_a_simulation_has_the_motion_of_the_engine_and_knows_its_spec(results: dict[str, Any]) -> None:
    from rthm_core.engine import simulate

    run, engine = results["simulate"], simulate(shipped_spec("paper"), 1.0)
    assert run.spec is shipped_spec("paper")
    assert np.array_equal(run.columns()["x1.position"].values, engine.plant_position[:, 0])
    assert np.array_equal(
        run.energies["E_err"], sum(engine.energies[one] for one in ("E_num", "E_ff", "E_fx"))
    )


def test_a_plant_alone_has_no_columns_of_a_loop() -> None:
    names = set(rthm.simulate("decay", 1.0).columns())
    assert "x1.position" in names and not any(name.endswith((".force", ".force_reference")) for name in names)


@pytest.mark.parametrize(("module", "ask"), [("pandas", "to_dataframe"), ("control", "to_control")])
def test_a_package_that_is_not_installed_is_named_with_the_way_to_it(
    module: str, ask: str, results: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(rthm.InputError, match=f"needs the package {module}, .* `pip install {module}`"):
        getattr(results["response"], ask)()


def test_a_table_of_pandas_has_the_columns_and_their_units(results: dict[str, Any]) -> None:
    pytest.importorskip("pandas")
    frame = results["simulate"].to_dataframe()
    assert list(frame.columns) == list(results["simulate"].columns())
    assert frame.attrs["units"]["x1.velocity"] == "m/s" and len(frame) == results["simulate"].t.size


def test_a_response_goes_to_python_control_and_back(results: dict[str, Any]) -> None:
    pytest.importorskip("control")
    there = results["response"].to_control("sampled")
    back = Response.from_control(there, "sampled")
    assert back.dofs == results["response"].dofs
    assert np.array_equal(back.omega, OMEGA)
    assert np.array_equal(back.ways["sampled"], results["response"].ways["sampled"])


def test_a_response_from_elsewhere_that_is_not_square_is_refused() -> None:
    tall = SimpleNamespace(frdata=np.zeros((2, 1, 3)), omega=OMEGA[:3], output_labels=["x1", "x2"])
    with pytest.raises(rthm.InputError, match="2 outputs and 1 inputs"):
        Response.from_control(tall)


def test_a_sweep_is_kept_in_a_folder_that_is_named(tmp_path: Path) -> None:
    first = rthm.sweep("paper", {"plant.mass": [1.1, 1.2]}, 0.0, folder=tmp_path / "kept")
    again = rthm.sweep("paper", {"plant.mass": [1.1, 1.2]}, 0.0, folder=tmp_path / "kept")
    assert (first.found_before, again.found_before) == (0, 2)
