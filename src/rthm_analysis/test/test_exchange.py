"""Recordings from and to the files of other tools."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.exchange import Columns, export_bag, import_files, wanted
from rthm_analysis.exchange.formats import read_columns, write_columns
from rthm_analysis.exchange.importing import import_data
from rthm_analysis.exchange.units import factor
from rthm_analysis.recording import Recording, hold, read_recording
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.spec import read_spec, shipped_spec

from .conftest import mcap_file
from .loop import recorded

PLANT = read_spec(
    "/**:\n  ros__parameters:\n    plant: {dofs: [x1], mass: [2.0], damping: [0.1], stiffness: [8.0], "
    "initial_position: [0.0], initial_velocity: [0.0]}\n"
)
FORMATS = ("csv", "mat", "parquet")


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """A hybrid test with all topics and links."""
    file = tmp_path_factory.mktemp("loop") / "loop.mcap"
    return read_recording(mcap_file(file, recorded(shipped_spec("paper"), 1.0)))


def table(path: Path, text: str) -> str:
    path.write_text(text, encoding="utf-8")
    return str(path)


def same(one: Recording, other: Recording) -> None:
    assert one.tables.keys() == other.tables.keys() and one.links.keys() == other.links.keys()
    for name, rows in one.tables.items():
        assert rows.names == other.tables[name].names
        np.testing.assert_array_equal(rows.stamp_ns, other.tables[name].stamp_ns)
        np.testing.assert_array_equal(rows.received_ns, other.tables[name].received_ns)
        for field in ("position", "velocity", "effort"):
            np.testing.assert_array_equal(getattr(rows, field), getattr(other.tables[name], field))
    for name, uses in one.links.items():
        np.testing.assert_array_equal(uses.use_ns, other.links[name].use_ns)
        np.testing.assert_array_equal(uses.sample_ns, other.links[name].sample_ns)


@pytest.mark.parametrize("form", FORMATS)
def test_a_hybrid_test_survives_export_and_import_to_the_last_bit(
    loop: Recording, tmp_path: Path, form: str
) -> None:
    export_bag(loop, tmp_path / "files", form)
    (imported,) = import_files([str(tmp_path / "files")], tmp_path / "bag", wanted([]))
    again = read_recording(imported.bag)
    same(loop, again)
    assert again.spec == loop.spec
    assert not imported.notes


@pytest.mark.parametrize("form", FORMATS)
def test_columns_survive_a_file_to_the_last_bit(tmp_path: Path, form: str) -> None:
    values = np.random.default_rng(1).standard_normal(50) * 10.0 ** np.arange(-25, 25)
    values[3] = np.nan
    stamps = np.arange(50) + 1_790_000_000_000_000_001
    columns = Columns("here", {"stamp": stamps, "a.b": values, "a_b": -values}, {"stamp": "ns", "a.b": "kN"})
    write_columns(tmp_path / f"some.{form}", columns)
    again = read_columns(tmp_path / f"some.{form}")
    assert list(again.values) == ["stamp", "a.b", "a_b"] and again.units == columns.units
    assert again.values["stamp"].dtype == np.int64
    for name in columns.values:
        np.testing.assert_array_equal(again.values[name], columns.values[name])


def test_one_table_holds_every_signal_between_its_samples(loop: Recording, tmp_path: Path) -> None:
    (file,) = export_bag(loop, tmp_path / "one.csv", rate=2000.0)
    columns = read_columns(file)
    assert columns.units["plant/state/x1.position"] == "m" and columns.units["time"] == "s"
    at = loop.start_ns + np.rint(columns.values["time"] * NS).astype(np.int64)
    assert np.diff(at).tolist() == [500_000] * (at.size - 1)
    for topic, heading, field, place in (
        ("plant/state", "plant/state/x1.position", "position", "x1"),
        ("numerical/force_reference", "numerical/force_reference/a1.effort", "effort", "a1"),
    ):
        samples = loop.tables[topic]
        held = hold(samples.stamp_ns, samples.columns(field, [place])[:, 0], at)
        np.testing.assert_array_equal(columns.values[heading], held)


def test_nothing_is_overwritten(loop: Recording, tmp_path: Path) -> None:
    export_bag(loop, tmp_path / "files")
    with pytest.raises(InputError, match="nothing is overwritten"):
        export_bag(loop, tmp_path / "files")


def test_a_table_of_a_test_rig_becomes_a_bag_in_si(tmp_path: Path) -> None:
    rig = table(
        tmp_path / "rig.csv",
        "# rig 7\nTime;Displacement;Load cell\n[ms];[mm];[kN]\n0;1,5;0,25\n2,5;-2;\n5;0,5;1\n",
    )
    maps = ["position:x1=Displacement", "force:a1=Load cell"]
    (found,) = import_files([rig], tmp_path / "bag", wanted(maps, spec=PLANT), PLANT)
    recording = read_recording(found.bag)
    assert recording.plant.names == ("x1", "a1") and recording.spec == PLANT
    assert recording.plant.stamp_ns.tolist() == [0, 2_500_000, 5_000_000]
    assert recording.plant.columns("position", ["x1"])[:, 0] == pytest.approx(
        [1.5e-3, -2e-3, 0.5e-3], abs=1e-18
    )
    force = recording.plant.columns("effort", ["a1"])[:, 0]
    assert force[[0, 2]] == pytest.approx([250.0, 1000.0]) and np.isnan(force[1])
    assert found.notes == (
        "the column Time is taken as the time in ms.",
        "1 of 3 values of Load cell are missing: kept as not known.",
    )


def test_what_the_user_says_about_units_overrules_the_file(tmp_path: Path) -> None:
    rig = table(tmp_path / "rig.csv", "t [s],y [m],u [V]\n0,1,2\n0.1,2,4\n")
    said = wanted(["position=y", "force=u"], ["position=mm", "force:a1=35.15", "time=ms"])
    (found,) = import_files([rig], tmp_path / "bag", said)
    plant = read_recording(found.bag).plant
    assert plant.position[:, 0] == pytest.approx([1e-3, 2e-3])
    assert plant.effort[:, 1] == pytest.approx([70.3, 140.6])
    assert plant.stamp_ns.tolist() == [0, 100_000]


def test_an_acceleration_goes_into_a_topic_of_its_own_and_back(tmp_path: Path) -> None:
    rig = table(tmp_path / "rig.csv", "t,y [mm],acc [mV]\n0,1,200\n0.1,2,250\n0.2,3,\n")
    maps = ["position=y", "acceleration=acc"]
    said = wanted(maps, ["acceleration=0.01 g"], spec=PLANT, offsets=["acceleration:x1=150"])
    (found,) = import_files([rig], tmp_path / "bag", said, PLANT)
    recording = read_recording(found.bag)
    measured = recording.tables["plant/acceleration"]
    assert recording.plant.names == measured.names == ("x1",) and found.names == ("x1",)
    assert np.isnan(recording.plant.effort).all()
    assert measured.effort[:2, 0] == pytest.approx([50 * 0.0980665, 100 * 0.0980665])
    assert np.isnan(measured.effort[2, 0])
    np.testing.assert_array_equal(measured.stamp_ns, recording.plant.stamp_ns)
    words = next(one.words for one in found.channels if one.role == "acceleration")
    assert words == "acceleration x1 is acc in 0.01 g: 4.9 to 9.81 m/s^2, mean 7.35 m/s^2"
    export_bag(recording, tmp_path / "files")
    (again,) = import_files([str(tmp_path / "files")], tmp_path / "again", wanted([]))
    same(recording, read_recording(again.bag))
    export_bag(recording, tmp_path / "one.csv")
    assert "plant/acceleration/x1.effort [m/s^2]" in (tmp_path / "one.csv").read_text()


def test_an_acceleration_alone_is_a_recording_of_its_dof(tmp_path: Path) -> None:
    rig = table(tmp_path / "rig.csv", "t,acc (deg/s^2),torque (N m)\n0,1,5\n0.1,180,6\n")
    said = wanted(["acceleration:arm=acc", "load:arm=torque"])
    (found,) = import_files([rig], tmp_path / "bag", said)
    recording = read_recording(found.bag)
    assert recording.plant.names == ("arm",) and recording.plant.effort[:, 0].tolist() == [5.0, 6.0]
    assert recording.tables["plant/acceleration"].effort[1, 0] == pytest.approx(np.pi)
    assert found.channels[0].unit == "rad/s^2"


def test_a_rate_gives_stamps_that_never_drift(tmp_path: Path) -> None:
    write_columns(tmp_path / "long.parquet", Columns("", {"y": np.sin(np.arange(200_000.0))}))
    said = wanted(["position=y"], rate=750.0)
    (found,) = import_files([str(tmp_path / "long.parquet")], tmp_path / "bag", said)
    stamps = read_recording(found.bag).plant.stamp_ns
    np.testing.assert_array_equal(stamps, [round(k * NS / 750) for k in range(200_000)])


def test_columns_without_names_are_numbered_and_matrices_taken_apart(tmp_path: Path) -> None:
    from scipy.io import savemat

    assert list(read_columns(Path(table(tmp_path / "a.txt", "0 1.5\n1 2.5\n"))).values) == ["1", "2"]
    savemat(tmp_path / "a.mat", {"rig": {"q": np.arange(12.0).reshape(6, 2), "fs": 100.0}, "label": "x"})
    columns = read_columns(tmp_path / "a.mat")
    assert columns.values["rig.q[1]"].tolist() == [1.0, 3.0, 5.0, 7.0, 9.0, 11.0]


@dataclass
class InputOutput:
    """What ``nonlinear_benchmarks`` returns: the attributes of its Input_output_data."""

    u: np.ndarray
    y: np.ndarray
    sampling_time: float | None = None
    name: str = ""


def test_benchmark_data_become_one_bag_for_each_part(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    part = [InputOutput(rng.normal(size=(n, 1)), rng.normal(size=n), 1 / 610.0) for n in (40, 30, 20)]
    part[2].name = "Silverbox arrow"
    found = import_data((part[0], (part[1], part[2])), tmp_path / "bags", wanted([]), PLANT)
    assert [(one.bag.name, one.samples) for one in found] == [
        ("data_train", 40),
        ("data_test_train", 30),
        ("Silverbox_arrow", 20),
    ]
    plant = read_recording(found[0].bag).plant
    np.testing.assert_array_equal(plant.columns("position", ["x1"])[:, 0], part[0].y)
    np.testing.assert_array_equal(plant.columns("effort", ["a1"])[:, 0], part[0].u[:, 0])
    assert plant.stamp_ns[-1] == round(39 / 610 * NS)


TIMED = "t,y\n0,1\n1e-3,2\n2e-3,4\n"


@pytest.mark.parametrize(
    ("text", "maps", "more", "sentence"),
    [
        (TIMED, [], {}, "none is said to be a position"),
        (TIMED, ["position=z"], {}, "no column 'z', but t, y"),
        (TIMED, ["place=y"], {}, "must be ROLE:NAME=COLUMN"),
        (TIMED, ["position:x9=y"], {"spec": PLANT}, "names x9, but the spec has x1"),
        (TIMED, ["position=y", "force:x1=y"], {"spec": PLANT}, "write load:x1"),
        (TIMED, ["position=y", "position=t"], {}, "mapped twice"),
        (TIMED, ["position=y"], {"units": ["position=V"]}, "the number of m that one of it is"),
        (TIMED, ["position=y"], {"units": ["position=0"]}, "the number of m that one of it is"),
        (TIMED, ["position=y"], {"units": ["speed=mm"]}, "must be ROLE=UNIT"),
        (TIMED, ["position=y"], {"rate": 0.0}, "from 1e-6 to 1e7 Hz"),
        (TIMED, ["position=y"], {"rate": 5.0, "time": "t"}, "both given"),
        (TIMED, ["position=y"], {"time": "s"}, "no column 's'"),
        ("a,y\n0,1\n1,2\n", ["position=y"], {}, "say --time COLUMN, or --rate HZ"),
        ("t,y\n0,1\n1,2\n1,3\n", ["position=y"], {}, "must increase"),
        ("t,y\n0,1\n,2\n2,3\n", ["position=y"], {}, "is nan s in sample 2"),
        ("t,y\n0,1\n1,inf\n", ["position=y"], {}, "must be finite"),
        ("t,y\n0,\n1,\n", ["position=y"], {}, "has no numbers"),
        ("t,y\n0,1\n1,wet\n", ["position=y"], {}, "line 3, column y: 'wet' is not a number"),
        ("t,y\n0,1\n1,2,3\n", ["position=y"], {}, "line 3, has 3 values, but must have 2"),
        ("", ["position=y"], {}, "has no rows"),
    ],
)
def test_what_cannot_be_used_is_said_in_one_sentence(
    tmp_path: Path, text: str, maps: list[str], more: dict, sentence: str
) -> None:
    rig = table(tmp_path / "rig.csv", text)
    with pytest.raises(InputError) as said:
        import_files([rig], tmp_path / "bag", wanted(maps, **more), more.get("spec"))
    assert sentence in str(said.value)
    assert "\n" not in str(said.value) and not (tmp_path / "bag").exists()


def test_what_is_odd_is_said_and_kept(tmp_path: Path) -> None:
    t = np.arange(100) * 0.01
    t[60:] += 0.5
    t[20] += 0.003
    columns = Columns("", {"t": t, "x": np.sin(5 * t), "v": 5e3 * np.cos(5 * t), "f": np.full(100, 7.0)})
    write_columns(tmp_path / "odd.csv", columns)
    said = wanted(["position=x", "velocity=v", "force=f"], time="t")
    (found,) = import_files([str(tmp_path / "odd.csv")], tmp_path / "bag", said)
    gap, uneven, fast, constant, disagreement, no_spec = found.notes
    assert gap.startswith("gaps in time: 1, the longest 0.51 s")
    assert "--rate 100 takes even ones" in uneven
    assert "velocity x1 reaches 5000 m/s" in fast
    assert constant.startswith("f is 7 N all the time")
    assert "times its change of position: are both units right?" in disagreement
    assert "no spec" in no_spec
    np.testing.assert_array_equal(read_recording(found.bag).plant.position[:, 0], columns.values["x"])


@pytest.mark.parametrize(
    ("unit", "si", "value"),
    [
        ("mm", "m", 1e-3),
        ("35.15", "N", 35.15),
        ("0.5 kN", "N", 500.0),
        ("2*mm/s", "m/s", 2e-3),
        ("µm", "m", 1e-6),
        ("g", "m/s^2", 9.80665),
        ("mG", "m/s^2", 9.80665e-3),
        ("Gal", "m/s^2", 0.01),
        ("mm/s²", "m/s^2", 1e-3),
        ("m/s/s", "m/s^2", 1.0),
        ("cm s^-2", "m/s^2", 1e-2),
        ("-0.5 m/s2", "m/s^2", -0.5),
        ("deg/s**2", "m/s^2", np.pi / 180.0),
    ],
)
def test_units_are_factors_to_si(unit: str, si: str, value: float) -> None:
    assert factor(unit, si, "y") == pytest.approx(value, rel=1e-15)


def test_a_table_in_degrees_below_title_lines_says_what_was_understood(tmp_path: Path) -> None:
    """A rig that turns, with an encoder whose zero is elsewhere and a moment of torque."""
    rows = [f"{0.005 * k:.3f},{12.5 + 0.1 * round(300 * np.sin(0.03 * k)):.1f},{100 * np.cos(0.03 * k):.2f}"
            for k in range(2000)]  # fmt: skip
    head = ["Rig 7, operator K. M.", "Test of 2026-11-26, 14:30", "", "Time [s],Theta [deg],Torque [mN m]"]
    file = table(tmp_path / "a.csv", "\n".join([*head, *rows]) + "\n")
    said = wanted(["position:x1=Theta", "load:x1=Torque"], offsets=["position:x1=12.5"])
    (found,) = import_files([file], tmp_path / "bag", said)
    plant = read_recording(found.bag).plant
    assert plant.position[:, 0].max() == pytest.approx(np.deg2rad(30.0))
    assert np.abs(plant.effort[:, 0]).max() == pytest.approx(0.1)
    assert found.sampling == "200 samples per second"
    turn, torque = found.channels
    assert (turn.file_unit, turn.unit, torque.unit) == ("deg", "rad", "N m")
    assert turn.step == pytest.approx(np.deg2rad(0.1)) and turn.readings == 1.0
    assert turn.words.startswith("position x1 is Theta in deg: -0.524 to 0.524 rad")


@pytest.mark.parametrize(
    ("head", "times"),
    [
        ("Messung;Stand 3;\nDatum;12.03.2026;\nZeit [s];Weg [mm];Note", "0,0 0,1 0,2"),
        ("Rate,500,\nTime,Weg,Note\ns,mm,", "0.0 0.1 0.2"),
        ("t_ms,Weg [mm],Note", "0 100 200"),
        ("Elapsed [ms],Weg [mm],Note", "0 100 200"),
        ("timestamp,Weg [mm],Note", "23:59:59.8 23:59:59.9 00:00:00.0"),
        (
            "timestamp,Weg [mm],Note",
            "2026-03-31T23:59:59.8Z 2026-03-31T23:59:59.9Z 2026-04-01T01:00:00.0+01:00",
        ),
        ("Datum;Weg [mm];Note", "31.03.2026T23:59:59,8 31.03.2026T23:59:59,9 1.4.2026T0:00:00,0"),
        ("Date,Weg [mm],Note", "3/31/2026T23:59:59.8 3/31/2026T23:59:59.9 4/1/2026T0:00:00.0"),
    ],
    ids=["titles", "units", "name with unit", "unit alone", "midnight", "iso", "days first", "month first"],
)
def test_tables_are_read_as_laboratories_write_them(tmp_path: Path, head: str, times: str) -> None:
    """Titles as wide as the table, remarks beside the numbers, and time in any form."""
    separator, decimal = (";", ",") if ";" in head else (",", ".")
    moved, notes = [0.5, 1.5, -2.5], ["", "here it knocked", ""]
    texts = [f"{value}".replace(".", decimal) for value in moved]
    rows = [separator.join(row) for row in zip(times.split(), texts, notes, strict=True)]
    file = table(tmp_path / "a.csv", "\n".join([head, *rows]) + "\n")
    (found,) = import_files([file], tmp_path / "bag", wanted(["position:x1=Weg"]))
    plant = read_recording(found.bag).plant
    np.testing.assert_allclose(plant.position[:, 0], 1e-3 * np.array(moved))
    assert np.diff(plant.stamp_ns).tolist() == [NS // 10] * 2
    with pytest.raises(InputError, match="Note has no numbers"):
        import_files([file], tmp_path / "other", wanted(["position:x1=Note"]))


def test_a_sensor_that_is_silent_at_first_costs_no_row_and_no_name(tmp_path: Path) -> None:
    file = table(tmp_path / "a.csv", "t,y,z\n0,nan,\n1,,nan\n2,5,6\n3,7,8\n")
    (found,) = import_files([file], tmp_path / "bag", wanted(["position:x1=y"]))
    assert read_recording(found.bag).plant.position[:, 0].tolist()[2:] == [5.0, 7.0] and found.samples == 4


def test_names_may_be_numbers_and_a_time_that_is_none_is_named(tmp_path: Path) -> None:
    file = table(tmp_path / "a.csv", "t,1,2\n0,5,6\n1,7,8\n")
    (found,) = import_files([file], tmp_path / "bag", wanted(["position:x1=2"]))
    assert read_recording(found.bag).plant.position[:, 0].tolist() == [6.0, 8.0]
    file = table(tmp_path / "b.csv", "t,y\n10:00:00,5\n10:00:61,late\n10:00:0x,6\n")
    with pytest.raises(InputError, match="line 4, column t: '10:00:0x' is not a time of day"):
        import_files([file], tmp_path / "other", wanted(["position:x1=y"]))


def test_a_slow_sensor_is_seen_in_a_table(tmp_path: Path) -> None:
    x = np.repeat(np.random.default_rng(1).normal(size=500), 4)
    file = table(
        tmp_path / "a.csv", "t,x\n" + "".join(f"{0.01 * k:.2f},{v!r}\n" for k, v in enumerate(x.tolist()))
    )
    (found,) = import_files([file], tmp_path / "bag", wanted(["position:x1=x"]))
    assert found.channels[0].readings == pytest.approx(0.25)
    assert "0.25 readings per sample" in found.channels[0].words


@pytest.mark.parametrize("text", ["position:x1=zero", "speed=1", "position=inf"])
def test_an_offset_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"--offset .* must be ROLE=NUMBER"):
        wanted(["position:x1=x"], offsets=[text])
