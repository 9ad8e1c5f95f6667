"""The open world's generator obeys its equations, conceals what can be seen, and scores what is said."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import yaml
from benchmarks.concealed.foresight import mean_age
from benchmarks.concealed.open.__main__ import main
from benchmarks.concealed.open.case import OpenCase, make_open_case
from benchmarks.concealed.open.catalogue import CLASSES, RECIPES
from benchmarks.concealed.open.faults import swapped
from benchmarks.concealed.open.plan import open_plan
from benchmarks.concealed.open.scale import Scale
from benchmarks.concealed.open.score import open_score
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.open.visibility import response, unabsorbed
from benchmarks.concealed.open.worlds import draw_plain
from benchmarks.concealed.simulate import run
from benchmarks.concealed.strange import LAWS
from rosbags.highlevel import AnyReader

TURN = 2.0 * np.pi
NOTHING = {"verdict": "match", "located": [], "physics": [], "retuned": {}}


def recorded(bag: Path) -> tuple[np.ndarray, np.ndarray]:
    """Instants in s and positions of a plant alone."""
    with AnyReader([bag]) as reader:
        rows = [
            (stamp, reader.deserialize(raw, c.msgtype).position[0])
            for c, stamp, raw in reader.messages()
            if c.topic.endswith("state")
        ]
    stamps, positions = zip(*rows, strict=True)
    return (np.array(stamps) - stamps[0]) * 1e-9, np.array(positions)


def free_plant(*effects: dict, damping: float = 0.0, duration: float = 20.0) -> np.ndarray:
    """x1, v1 of a plant alone from 0.1 m, every 2 ms: 2 kg, 50 N/m."""
    test = draw_plain(np.random.default_rng(1), loaded=False).test
    test.spec["plant"] |= {
        "mass": [2.0],
        "damping": [damping],
        "stiffness": [50.0],
        "initial_position": [0.1],
    }
    test.spec["timing"]["td1"] = 0.002
    for i, effect in enumerate(effects):
        test.spec.setdefault("effects", []).append(f"e{i}")
        test.spec[f"e{i}"] = {"block": "plant"} | effect
    return run(test, duration, 0, noisy=False).plant[:, 4:6]


def test_a_clean_decay_in_the_bag_is_the_closed_form_of_its_spec(tmp_path: Path) -> None:
    case = make_open_case(7, "sparse", tmp_path)
    t, x = recorded(case.bag)
    plant = yaml.safe_load(case.spec.read_text())["/**"]["ros__parameters"]["plant"]
    M, c, k, x0 = (plant[n][0] for n in ("mass", "damping", "stiffness", "initial_position"))
    decay = 0.5 * c / M
    w = np.sqrt(k / M - decay**2)
    true = x0 * np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    assert (x - true).std() == pytest.approx(case.truth["noise"][0], rel=0.1)
    late, early = (x - true)[1:], (x - true)[:-1]
    assert abs(np.corrcoef(late, early)[0, 1]) < 0.15


@pytest.mark.parametrize(
    ("law", "potential"),
    [
        ({"kind": "tanh_spring", "values": [1.0, 0.03]}, lambda x: 0.03 * np.log(np.cosh(x / 0.03))),
        ({"kind": "sine_stiffness", "values": [1.0, 0.08]}, lambda x: -0.08 * np.cos(x / 0.08)),
        ({"kind": "magnet", "values": [1.0, 0.2]}, lambda x: x - 0.2 / (1.0 - x / 0.2)),
        ({"kind": "cogging", "values": [1.0, 0.05, 0.0]}, lambda x: 0.05 / TURN * np.cos(TURN * x / 0.05)),
    ],
)  # fmt: skip
def test_laws_of_the_position_alone_keep_the_energy(law: dict, potential) -> None:
    x, v = free_plant(law).T
    energy = v**2 + 25.0 * x**2 + potential(x)
    assert np.ptp(energy) < 1e-6 * np.ptp(25.0 * x**2)


def test_friction_in_an_interval_takes_its_force_times_the_way_within() -> None:
    x, v = free_plant({"kind": "interval_friction", "values": [0.2, 0.02, 0.05]}).T
    lost = 0.25 - (v**2 + 25.0 * x**2)[-1]
    way = np.abs(np.diff(np.clip(x, 0.02, 0.05))).sum()
    assert lost == pytest.approx(0.2 * way, rel=2e-3)


def test_a_mass_that_doubles_the_period_is_four_times_as_large() -> None:
    x, _ = free_plant({"kind": "stepping_mass", "values": [6.0, 0.0]}).T
    rises = np.flatnonzero((x[1:] > 0.0) & (x[:-1] <= 0.0))
    assert np.diff(rises).mean() * 0.002 == pytest.approx(2.0 * 2.0 * np.pi / 5.0, rel=2e-3)


def test_the_same_motion_in_other_units_obeys_the_scaled_equation() -> None:
    scale = Scale(length=1e-3, time=1e-2, mass=10.0)
    plant = {"mass": [2.0], "damping": [0.5], "stiffness": [50.0]}
    real = scale.spec({"plant": plant})["plant"]
    frequency = [np.sqrt(p["stiffness"][0] / p["mass"][0]) for p in (plant, real)]
    assert frequency[1] == pytest.approx(frequency[0] / scale.time)
    drag = {"block": "plant", "kind": "quadratic_drag", "coefficient": 3.0}
    v, force = 0.7 * scale.factor((1, -1, 0)), 3.0 * 0.7**2 * scale.factor((1, -2, 1))
    assert scale.effect(drag)["coefficient"] * v**2 == pytest.approx(force)


def test_swapped_channels_keep_their_numbers_at_the_scale_of_the_rig() -> None:
    scale = Scale(length=1e-3, time=1e-2, mass=10.0)
    before = np.random.default_rng(0).normal(size=(5, 11))
    log = SimpleNamespace(plant=before.copy())
    swapped(1, 3)(cast("Any", log), cast("Any", SimpleNamespace(setting=SimpleNamespace(scale=scale))))
    real = [plant[:, :4] * scale.channels for plant in (before, log.plant)]
    assert real[1] == pytest.approx(real[0][:, [0, 3, 2, 1]])


def test_visible_is_only_what_no_linear_plant_takes_up() -> None:
    t = np.linspace(0.0, 20.0, 4000)
    x, v = np.sin(5.0 * t), 5.0 * np.cos(5.0 * t)
    columns = np.stack([-25.0 * x, v, x, np.ones_like(t)], axis=1)
    assert np.abs(unabsorbed(3.0 * x - 0.2 * v + 0.1, columns)).max() < 1e-10
    assert np.std(unabsorbed(x**3, columns)) > 0.1
    moved = response(2.0, 4.0, 50.0, t[1], np.ones_like(t))
    assert moved[-1] == pytest.approx([1.0 / 50.0, 0.0], abs=1e-4)


def test_mean_ages_are_those_of_drawn_out_clocks() -> None:
    tau, sampled, used = 4_000_000, 1_200_000, 4_000_000
    ticks = np.arange(3, 10_000) * used
    ages = ticks - (ticks - tau) // sampled * sampled
    assert mean_age(tau * 1e-9, sampled * 1e-9, used * 1e-9) == pytest.approx(ages.mean() * 1e-9, rel=1e-3)


def test_a_plan_has_every_class_and_a_hundred_clean_cases() -> None:
    items = open_plan(5, 320)
    counts = {group: sum(i.group == group for i in items) for group in CLASSES}
    assert counts == {"unlisted": 160, "spoiled": 22, "parameters": 16, "listed": 16, "clean": 106}
    assert len({i.seed for i in items}) == 320
    assert {i.name for i in items} == set(RECIPES)
    assert len(CLASSES["unlisted"]) > 20
    assert set(LAWS) <= set(CLASSES["unlisted"])


@pytest.mark.parametrize(
    "name",
    [
        "late_cable",
        "wrong_sign",
        "issue_rig",
        "interval_friction",
        pytest.param("other_tau4", marks=pytest.mark.long),
    ],
)
def test_a_case_is_the_same_for_the_same_seed_and_can_be_seen(name: str, tmp_path: Path) -> None:
    one, two = (make_open_case(3, name, tmp_path / n) for n in "ab")
    assert one.spec.read_text() == two.spec.read_text()
    assert one.truth["visibility"] == two.truth["visibility"] >= 1.0
    assert "effects" not in yaml.safe_load(one.spec.read_text())["/**"]["ros__parameters"]


def case_of(*hidden: Hidden, allowed: tuple[str, ...] = (), tolerated: tuple[Hidden, ...] = ()) -> OpenCase:
    return OpenCase(Path(), Path(), "", list(hidden), allowed, list(tolerated), {})


def said_of(verdict: str, *named: tuple[str, str], key: str = "physics", **more: object) -> dict:
    entries = [{"block": b, "kind": k} for b, k in named]
    return NOTHING | {"verdict": verdict, "located": ["plant"], key: entries} | more


RUB = Hidden("friction in an interval", ("plant",), ("friction",), depends=("x", "v"))
STIFF = Hidden("k", ("plant",), retuned=("plant.stiffness",), parameters={"plant.stiffness": 50.0})
SIGN = Hidden("sign", ("sensor.velocity",), faults=("sign",), kind="scale")
CURVE = {"block": "plant", "dof": "x1", "depends_on": ["x"]}


@pytest.mark.parametrize(
    ("hidden", "said", "wrong"),
    [
        (RUB, said_of("match"), True),
        (RUB, said_of("retuned", retuned={"plant.damping": {"value": 1.0, "std": 0.1}}), True),
        (RUB, said_of("explained", ("plant", "position_friction")), False),
        (RUB, said_of("explained", ("plant", "end_stop")), True),
        (RUB, said_of("explained", ("plant", "coulomb_friction"), ("plant", "harmonic_load")), True),
        (RUB, said_of("explained", described=[CURVE]), False),
        (RUB, said_of("explained", described=[CURVE | {"depends_on": ["t"]}]), True),
        (RUB, said_of("explained"), True),
        (RUB, said_of("improved", ("plant", "end_stop")), False),
        (RUB, said_of("unexplained"), False),
        (STIFF, said_of("retuned", retuned={"plant.stiffness[0]": {"value": 50.1, "std": 0.1}}), False),
        (STIFF, said_of("explained", ("plant", "clearance")), True),
        (SIGN, said_of("explained", ("sensor.velocity", "sign"), key="faults"), False),
        (SIGN, said_of("explained", ("sensor.force", "sign"), key="faults"), True),
        (SIGN, said_of("explained", ("sensor.velocity", "scale")), False),
    ],
)
def test_wrong_is_a_confident_answer_that_is_not_right(hidden: Hidden, said: dict, wrong: bool) -> None:
    assert open_score(case_of(hidden), said)["wrong"] is wrong


def test_names_that_are_not_true_are_invented_where_nothing_is_explained() -> None:
    assert open_score(case_of(RUB), said_of("improved", ("plant", "end_stop")))["invented"]
    assert not open_score(case_of(RUB), said_of("improved", ("plant", "lugre")))["invented"]
    assert open_score(case_of(RUB), said_of("unexplained"))["block"]
    assert not open_score(case_of(SIGN), said_of("unexplained"))["block"]


def test_an_alarm_is_anything_but_what_is_there() -> None:
    step = Hidden("coarse", ("sensor.position",), kind="quantisation")
    assert not open_score(case_of(), said_of("match"))["alarm"]
    assert open_score(case_of(), said_of("retuned"))["alarm"]
    assert not open_score(case_of(allowed=("retuned",)), said_of("retuned"))["alarm"]
    assert open_score(case_of(), said_of("explained", ("plant", "clearance")))["wrong"]
    told = said_of("explained", ("sensor.position", "quantisation"))
    assert not open_score(case_of(tolerated=(step,)), told)["alarm"]


def test_values_are_within_two_of_their_standard_deviations() -> None:
    for value, covered in ((50.15, 1), (50.3, 0)):
        said = said_of("retuned", retuned={"plant.stiffness": {"value": value, "std": 0.1}})
        assert open_score(case_of(STIFF), said)["values"] == [covered, 1]


def test_both_parts_are_on_one_page_and_go_on_where_they_stopped(tmp_path: Path) -> None:
    answer = tmp_path / "answer.json"
    answer.write_text(json.dumps(NOTHING))
    words = ["--cases", "6", "--out", str(tmp_path / "table_open"), "--command", f"cat {answer}"]
    main([*words, "--limit", "2"])
    main(words)
    header, *rows = (json.loads(line) for line in (tmp_path / "table_open.jsonl").read_text().splitlines())
    assert sorted(r["index"] for r in rows) == list(range(6))
    page = (tmp_path / "table.md").read_text()
    assert str(header["master"]) in page
    assert "First part" not in page
