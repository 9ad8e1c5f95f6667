"""The generator of concealed cases integrates the contract's equations in the contract's event order."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from benchmarks.concealed.__main__ import main
from benchmarks.concealed.amounts import Scene
from benchmarks.concealed.case import make_case, spec_text
from benchmarks.concealed.kinds import CATALOGUE, family, make_effect
from benchmarks.concealed.loads import load, tabulate
from benchmarks.concealed.loop import SEEN, TRUE, Recording
from benchmarks.concealed.plan import plan
from benchmarks.concealed.score import score
from benchmarks.concealed.simulate import replay, run
from benchmarks.concealed.visibility import visibility
from benchmarks.concealed.world import HybridTest, ns
from rosbags.highlevel import AnyReader

ROOT = Path(__file__).parents[1]

SINES = np.array([[0.6, 1.7, 0.3], [0.5, 4.4, 1.9], [0.4, 9.1, 4.0], [0.4, 17.0, 2.2]])
MEMBERS = {"link.*": ("link.tau1", "link.tau2", "link.tau3", "link.tau4"),
           "sensor.*": ("sensor.position", "sensor.velocity", "sensor.force")}  # fmt: skip
EFFECTS = [(b, kind) for block, kind in CATALOGUE for b in MEMBERS.get(block, (block,))]
SMOOTH = {"position": 1e-4, "velocity": 2e-3, "motor": 1e-5, "force": 0.02}


def paper(**changes: dict) -> HybridTest:
    """Return the paper's test with motor poles, two loads and clocks that rarely tick together."""
    spec = {
        "plant": {"mass": [1.2], "damping": [0.05], "stiffness": [12.0], "initial_position": [0.1]},
        "numerical": {"mass": [1.5], "damping": [0.05], "stiffness": [6.0]},
        "interface": {"stiffness": [6.0], "damping": [0.1]},
        "actuator": {"names": ["a1"], "stiffness": [40.0], "motor_poles": [400.0, 2000.0]},
        "timing": {"td1": 0.0012, "td2": 0.011, "td3": 0.004, "td4": 0.0,
                   "tau1": 0.004, "tau2": 0.008, "tau3": 0.0125, "tau4": 0.01},
    }  # fmt: skip
    for section, values in changes.items():
        spec.setdefault(section, {}).update(values)
    return HybridTest(spec, SINES.copy(), 2.0, 0.5 * SINES, 2.0)


def bare(**changes: dict) -> HybridTest:
    """Return a test with h(s) = 1 and without loads."""
    test = paper(**changes)
    del test.spec["actuator"]["motor_poles"]
    return HybridTest(test.spec)


def alone(test: HybridTest, duration: float, step: float = 1e-4) -> np.ndarray:
    """Return x1, v1, u, F of the plant in steady state under the initial command."""
    td1 = ns(test.spec["timing"]["td1"])
    none = np.zeros(0, dtype=np.int64)
    rows = np.zeros((ns(duration) // td1 + 1, 11))
    log = Recording(rows, rows, none, rows, none, none, np.zeros(0), none)
    return replay(test, log, step=step)


@pytest.fixture(scope="module")
def pilot() -> np.ndarray:
    return run(paper(), 12.0, 1, noisy=False).plant[:, TRUE]


def with_effect(block: str, kind: str, pilot: np.ndarray, size: float = 0.15) -> HybridTest:
    test = paper()
    effect = make_effect(block, kind, size, Scene(test.spec, pilot, np.random.default_rng(7)))
    test.spec |= {"effects": ["hidden"], "hidden": effect}
    return test


def test_free_motion_under_a_held_command_is_the_closed_form() -> None:
    test = bare(plant={"damping": [0.7]})
    M, c, k, k_tot, x0 = 1.2, 0.7, 12.0, 40.0, 0.1
    x, _, u, F = alone(test, 10.0).T
    rest = k_tot * u[0] / (k + k_tot)
    decay, w = c / (2 * M), np.sqrt((k + k_tot) / M - (c / (2 * M)) ** 2)
    t = 0.0012 * np.arange(len(x))
    swing = np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    assert np.abs(x - (rest + (x0 - rest) * swing)).max() < 1e-9
    assert np.abs(F - k_tot * (u - x)).max() < 1e-12


def test_energy_of_an_undamped_plant_stays() -> None:
    x, v, u, _ = alone(bare(plant={"damping": [0.0]}), 20.0).T
    energy = 0.6 * v**2 + 6.0 * x**2 + 20.0 * (u - x) ** 2
    assert np.ptp(energy) < 1e-9 * energy[0]


def test_dry_friction_takes_force_times_way_and_then_holds() -> None:
    friction = {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.4}
    test = bare(plant={"damping": [0.0]})
    test.spec |= {"effects": ["guide"], "guide": friction}
    x, v, u, _ = alone(test, 20.0).T
    energy = 0.6 * v**2 + 6.0 * x**2 + 20.0 * (u - x) ** 2
    turns = np.concatenate([[0], np.flatnonzero(np.diff(np.sign(v[v != 0.0]))), [len(x) - 1]])
    way = np.abs(np.diff(x[turns])).sum()
    assert energy[0] - energy[-1] == pytest.approx(0.4 * way, rel=1e-3)
    stuck = x[-1000:]
    assert np.ptp(stuck) == 0.0
    assert abs(40.0 * (u[-1] - stuck[-1]) - 12.0 * stuck[-1]) <= 0.4


def test_a_step_of_half_the_size_moves_nothing() -> None:
    coarse, fine = (run(paper(), 10.0, 3, step=s).plant[:, TRUE] for s in (1e-4, 5e-5))
    assert np.abs(coarse - fine)[:, 0].max() < 1e-9


@pytest.mark.parametrize(("block", "kind"), EFFECTS)
def test_every_effect_moves_the_recording_and_its_integration_has_converged(
    block: str, kind: str, pilot: np.ndarray
) -> None:
    test = with_effect(block, kind, pilot)
    coarse, fine = (run(test, 6.0, 3, step=s) for s in (1e-4, 5e-5))
    assert np.abs(coarse.plant[:, TRUE] - fine.plant[:, TRUE])[:, 0].max() < 1e-7
    assert visibility(test, "hidden", coarse) > 1.0


def test_commands_are_what_the_contract_says_of_the_recorded_values() -> None:
    log = run(paper(), 6.0, 5)
    x1 = np.full(len(log.command), 0.1)
    ticks = log.command_stamp % 4_000_000 == 0
    used = log.use[0, : log.count[2], 1] // 1_200_000
    late = np.flatnonzero(ticks)[-len(used) :]
    x1[late] = log.plant[used, 0]
    for i in np.flatnonzero(~ticks):
        x1[i] = x1[i - 1]
    number = (log.command_stamp - 12_500_000) // 11_000_000
    F_d = np.where(number < 0, 0.6 * -1.0, log.numerical[np.maximum(number, 0), 3])
    assert np.abs(log.command[:, 1] - F_d).max() < 1e-15
    assert np.abs(log.command[:, 0] - (x1 + F_d / 40.0)).max() < 1e-15


def test_links_deliver_the_newest_sample_that_is_old_enough() -> None:
    log = run(paper(), 6.0, 5)
    for i, (period, tau) in enumerate(((4_000_000, 4_000_000), (11_000_000, 8_000_000))):
        use, stamp = log.use[i, : log.count[2 + i]].T
        ticks = np.arange(0, 6_000_000_001, period)
        expected = (ticks - tau) // 1_200_000 * 1_200_000
        assert np.array_equal(use, ticks[expected >= 0])
        assert np.array_equal(stamp, expected[expected >= 0])
    for i, tau in ((2, 12_500_000), (3, 10_000_000)):
        use, stamp = log.use[i, : log.count[2 + i]].T
        assert np.array_equal(use - stamp, np.full(len(use), tau))


def test_a_sample_sees_the_command_that_falls_due_at_its_instant() -> None:
    test = bare(timing={"tau3": 0.012, "td2": 0.012})
    log = run(test, 6.0, 5, noisy=False)
    t = 1_200_000 * np.arange(len(log.plant))
    due = np.searchsorted(log.command_stamp + 10_000_000, t, side="right") - 1
    before = 0.1 + (-6.0 * 0.1) / 40.0
    assert np.array_equal(log.plant[:, 2], np.where(due < 0, before, log.command[due, 0]))
    assert np.any((log.command_stamp[np.maximum(due, 0)] + 10_000_000) == t)


def test_nothing_moves_before_the_first_command_is_due() -> None:
    log = run(bare(), 0.1, 5, noisy=False)
    first = 1_200_000 * np.arange(len(log.plant)) < 10_000_000
    assert np.ptp(log.plant[first, 2]) == 0.0
    assert log.plant[0, 3] == pytest.approx(-6.0 * 0.1, abs=1e-14)


def test_a_transmission_without_inertia_is_its_stiffness() -> None:
    gear = {"spring": 2.0, "wire": 80.0, "radius": 0.05, "inertia": 1e-9, "damping": 1e-7}
    soft = bare(actuator={"stiffness": [1.0 / (1 / 80.0 + 0.05**2 / 2.0)]})
    geared = bare(actuator={"transmission": gear})
    x, y = alone(soft, 1.0, step=1e-6)[:, 0], alone(geared, 1.0, step=1e-6)[:, 0]
    assert np.abs(x - y).max() < 1e-6


def test_known_loads_are_their_sum_of_sines() -> None:
    table = tabulate(SINES, 2.0, 10.0)
    t = np.random.default_rng(1).uniform(0.0, 10.0, 2000)
    exact = sum(a * np.sin(w * t + p) for a, w, p in SINES) * np.minimum(t / 2.0, 1.0)
    assert np.abs(np.array([load(s, table) for s in t]) - exact).max() < 1e-9


def test_sensors_have_the_reference_noise() -> None:
    log = run(paper(), 30.0, 9)
    noise = (log.plant[:, SEEN] - log.plant[:, TRUE]).std(axis=0)
    assert noise == pytest.approx(list(SMOOTH.values()), rel=0.03)


def test_lost_and_late_samples_are_as_many_as_asked() -> None:
    test = paper()
    test.spec |= {"effects": ["a", "b"], "a": {"block": "link.tau3", "kind": "loss", "fraction": 0.1},
                  "b": {"block": "link.tau4", "kind": "jitter", "std": 0.0003}}  # fmt: skip
    log = run(test, 60.0, 9)
    assert 1.0 - log.count[4] / log.count[0] == pytest.approx(0.1, abs=0.02)
    late = (log.use[3, : log.count[5], 0] - log.use[3, : log.count[5], 1] - 10_000_000) * 1e-9
    assert late.min() >= 0.0
    assert np.sqrt(np.mean(late**2)) == pytest.approx(0.0003, rel=0.05)


def test_an_offset_clock_shows_in_the_stamps_and_in_the_delay() -> None:
    test = paper()
    test.spec |= {"effects": ["a"], "a": {"block": "link.tau1", "kind": "clock_offset", "offset": 0.0024}}
    use, stamp = run(test, 6.0, 9).use[0, 10:1400].T
    assert np.array_equal((stamp - 2_400_000) % 1_200_000, np.zeros(len(stamp)))
    assert (use - stamp).min() == 4_000_000


def test_a_case_is_a_bag_with_every_topic_and_tells_nothing_in_its_spec(tmp_path: Path) -> None:
    case = make_case(11, (("plant", "coulomb_friction"),), 0.05, tmp_path, duration=5.0)
    nominal = yaml.safe_load(case.spec.read_text())["/**"]["ros__parameters"]
    assert "effects" not in nominal
    assert case.truth["visibility"]["effect1"] >= 1.0
    with AnyReader([case.bag]) as reader:
        messages = [(c.topic, t, reader.deserialize(raw, c.msgtype)) for c, t, raw in reader.messages()]
    topic, start, said = messages[0]
    assert (topic, said.data) == ("/rthm/spec", spec_text(nominal))
    assert {m[0] for m in messages} == {"/rthm/spec", *(f"/rthm/{t}" for t in (
        "plant/state", "numerical/state", "numerical/force_reference", "actuator/command",
        "links/tau1", "links/tau2", "links/tau3", "links/tau4"))}  # fmt: skip
    state = [m for m in messages if m[0] == "/rthm/plant/state"]
    assert [t - start for _, t, _ in state] == list(range(0, 5 * 10**9 + 1, ns(nominal["timing"]["td1"])))
    last = state[-1][2]
    assert last.header.stamp.sec * 10**9 + last.header.stamp.nanosec == state[-1][1]
    assert last.name == ["x1", "a1"]
    assert [*last.position, *last.effort[1:]] == [*case.log.plant[-1, [0, 2]], case.log.plant[-1, 3]]
    assert last.velocity[0] == case.log.plant[-1, 1]
    assert np.isnan(last.velocity[1])


def test_the_same_seed_gives_the_same_case(tmp_path: Path) -> None:
    one, two = (make_case(5, (), 0.05, tmp_path / n, duration=3.0) for n in "ab")
    assert one.truth == two.truth
    assert np.array_equal(one.log.plant, two.log.plant)


def test_the_generator_imports_nothing_of_the_project() -> None:
    code = (
        "import sys, benchmarks.concealed.__main__; print([m for m in sys.modules if m.startswith('rthm')])"
    )
    said = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def test_a_plan_has_every_kind_equally_often() -> None:
    items = plan(3, 2 * len(CATALOGUE), 10, 3, 2, 4)
    counts = [
        sum(family(*i.kinds[0]) == f for i in items if i.group == "effect") for f in ("friction", "parameter")
    ]
    assert counts == [6, 4]
    assert len({i.seed for i in items}) == len(items)


NOTHING = {"verdict": "match", "located": [], "physics": [], "alternatives": [], "retuned": {}, "fits": []}


def said_of(*effects: tuple[str, str], verdict: str = "explained") -> dict:
    physics = [{"block": b, "kind": k} for b, k in effects]
    return NOTHING | {"verdict": verdict, "located": sorted({b for b, _ in effects}), "physics": physics}


def test_scores_count_exactly_the_true_effects(tmp_path: Path) -> None:
    item = next(i for i in plan(3, 37, 0, 0, 0, 0) if i.kinds == (("motor", "extra_delay"),))
    case = make_case(item.seed, item.kinds, item.size, tmp_path, duration=3.0)
    keys = ("block", "family", "kind")
    right = score(item, case, said_of(("link.tau4", "extra_delay")))
    assert [right[k] for k in keys] == [True, True, True]
    other = score(item, case, said_of(("motor", "lag")))
    assert [other[k] for k in keys] == [True, True, False]
    more = score(item, case, said_of(("motor", "extra_delay"), ("plant", "coulomb_friction")))
    assert [more[k] for k in keys] == [False, False, False]
    assert not score(item, case, NOTHING)["block"]
    delay = case.truth["spec"]["effect1"]["delay"]
    for off, covered in ((1.5, 1), (3.0, 0)):
        stated = {"delay": {"value": delay + off * 1e-3, "std": 1e-3}}
        named = {"block": "motor", "kind": "extra_delay", "parameters": stated}
        assert score(item, case, NOTHING | {"physics": [named]})["values"] == [covered, 1]
    fit = {"signal": "u", "held_out": [2.0, 3.0], "nrmse": {"explained": 2.0 * case.floor("u", 2.0, 3.0)}}
    assert score(item, case, NOTHING | {"fits": [fit]})["held_out"] == pytest.approx(2.0)


def test_an_alarm_is_anything_but_a_match_where_nothing_is_missing(tmp_path: Path) -> None:
    item = copy.copy(plan(3, 0, 1, 0, 0, 0)[0])
    case = make_case(item.seed, (), item.size, tmp_path, duration=3.0)
    assert not score(item, case, NOTHING)["alarm"]
    assert score(item, case, said_of(("plant", "quadratic_drag")))["alarm"]


def test_the_table_goes_on_where_it_stopped(tmp_path: Path) -> None:
    answer = tmp_path / "answer.json"
    answer.write_text(json.dumps(NOTHING))
    out = tmp_path / "out" / "table"
    words = [
        "--bags",
        "1",
        "--clean",
        "2",
        "--pairs",
        "0",
        "--triples",
        "0",
        "--retuned",
        "0",
        "--duration",
        "3",
    ]
    words += ["--out", str(out), "--command", f"cat {answer}"]
    main([*words, "--limit", "1"])
    main(words)
    header, *rows = (json.loads(line) for line in out.with_suffix(".jsonl").read_text().splitlines())
    assert sorted(r["index"] for r in rows) == [0, 1, 2]
    assert json.loads(out.with_suffix(".json").read_text())["summary"]["block"] == [0, 1]
    assert str(header["master"]) in out.with_suffix(".md").read_text()
