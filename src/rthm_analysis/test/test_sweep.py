"""Sweeps: what is run, where, and that nothing is run twice."""

import subprocess
import sys
import time

import numpy as np
import pytest

from rthm_analysis.sweep.batch import Order
from rthm_analysis.sweep.labels import label
from rthm_analysis.sweep.picture import SHOWN, draw, quantities
from rthm_analysis.sweep.points import SCALE, changed, check_ends, draws, grid
from rthm_analysis.sweep.quantities import QUANTITIES, measure
from rthm_analysis.sweep.ranges import Range, given_range
from rthm_analysis.sweep.sweep import sweep
from rthm_analysis.sweep.workers import cluster_workers, local_workers
from rthm_core.errors import InputError
from rthm_core.spec import apply, shipped_spec

PAPER = shipped_spec("paper")


def order(*keys, duration=0.0):
    return Order(PAPER.expanded(), keys, duration)


def test_a_grid_is_every_combination_with_the_last_key_fastest():
    ranges = [given_range("a=1:3:3"), given_range("b=0.1,0.2")]
    expected = [[1, 0.1], [1, 0.2], [2, 0.1], [2, 0.2], [3, 0.1], [3, 0.2]]
    np.testing.assert_allclose(grid(ranges), expected)


def test_logarithmic_values_have_equal_ratios():
    np.testing.assert_allclose(given_range("k=1:100:3:log").values, [1.0, 10.0, 100.0])


def test_draws_follow_from_the_seed_and_stay_between_the_ends():
    ranges = [Range("a", np.array([2.0, 3.0])), Range("b", np.array([1.0, 1000.0]), log=True)]
    one = draws(ranges, 4000, 7)
    assert np.array_equal(one, draws(ranges, 4000, 7))
    assert not np.array_equal(one, draws(ranges, 4000, 8))
    assert one[:, 0].min() >= 2.0 and one[:, 0].max() <= 3.0
    assert np.median(one[:, 1]) == pytest.approx(np.sqrt(1000.0), rel=0.1)


@pytest.mark.parametrize(
    "text", ["tau1", "tau1=", "tau1=1:2", "tau1=1:2:0", "tau1=0:2:3:log", "=1:2:3", "a=1:x:2"]
)
def test_values_that_are_not_understood_are_refused_in_a_sentence(text):
    with pytest.raises(InputError, match="not understood"):
        given_range(text)


def test_ends_that_the_spec_does_not_allow_are_refused_before_anything_runs():
    with pytest.raises(InputError, match="mass"):
        check_ends(PAPER, [given_range("plant.mass=-1:1:3")])


def test_scale_is_a_factor_on_all_times():
    assert changed(PAPER, (SCALE,), [2.0]).timing.tau4 == 2.0 * PAPER.timing.tau4


def test_one_millisecond_of_position_cancellation_is_a_damper_of_k_tot_tau1():
    """Fig. 10 of the paper: no other delays, no damping."""
    still = {f"timing.{name}": 0.0 for name in ("tau2", "tau3", "tau4")}
    quick = {f"timing.{name}": 1e-4 for name in ("td1", "td2", "td3")}
    bare = {f"{side}.damping": [0.0] for side in ("plant", "numerical", "interface")}
    found, _ = measure(apply(PAPER, still | quick | bare | {"timing.tau1": 0.001}), 3.0)
    assert found["equivalent_damping"] == pytest.approx(40.0 * (0.001 + 0.5e-4), rel=0.03)
    assert found["balance_error"] < 1e-9


def test_a_table_has_what_each_loop_has_alone(tmp_path):
    values = grid([given_range("timing.scale=0.5:1.5:2"), given_range("actuator.stiffness=20,40")])
    with local_workers(1) as workers:
        done = sweep(order("timing.scale", "actuator.stiffness", duration=1.0), values, tmp_path, workers)
    for row, (scale, stiffness) in zip(done.table.to_pylist(), values, strict=True):
        alone, _ = measure(apply(PAPER, {"actuator.stiffness": stiffness}).scaled_timing(scale), 1.0)
        assert row["timing.scale"] == scale and row["actuator.stiffness"] == stiffness
        assert {name: row[name] for name in QUANTITIES} == pytest.approx(alone, nan_ok=True)
        assert row["stable"] and not row["refused"]


def test_an_interrupted_sweep_goes_on_where_it_stopped(tmp_path):
    values = grid([given_range("actuator.stiffness=2:60:40")])

    def interrupt(done):
        if done >= 8:
            raise KeyboardInterrupt

    with local_workers(1) as workers:
        with pytest.raises(KeyboardInterrupt):
            sweep(order("actuator.stiffness"), values, tmp_path, workers, interrupt)
        before = {file: file.stat().st_mtime_ns for file in (tmp_path / "batches").iterdir()}
        done = sweep(order("actuator.stiffness"), values, tmp_path, workers)
        again = sweep(order("actuator.stiffness"), values, tmp_path, workers)
    assert done.found_before >= 8
    assert all(file.stat().st_mtime_ns == changed_at for file, changed_at in before.items())
    assert done.table["loop"].to_pylist() == list(range(40))
    assert again.found_before == 40 and again.batches == 0
    assert again.table.equals(done.table)


def test_batches_grow_until_they_take_their_time(tmp_path):
    values = grid([given_range("actuator.stiffness=5:60:80")])
    with local_workers(1) as workers:
        done = sweep(order("actuator.stiffness"), values, tmp_path, workers)
    assert done.batches < 40


def test_another_sweep_in_the_same_folder_is_refused_in_a_sentence(tmp_path):
    with local_workers(1) as workers:
        sweep(order("timing.tau1"), np.array([[0.004]]), tmp_path, workers)
        with pytest.raises(InputError, match="another sweep"):
            sweep(order("timing.tau1"), np.array([[0.005]]), tmp_path, workers)


def test_a_loop_that_cannot_be_followed_is_a_row_with_its_sentence(tmp_path):
    with local_workers(1) as workers:
        done = sweep(order("timing.tau4"), np.array([[0.01], [3000.0]]), tmp_path, workers)
    fine, refused = done.table.to_pylist()
    assert fine["stable"] is True and fine["refused"] == ""
    assert refused["stable"] is None and "in transit" in refused["refused"]


def test_several_processes_find_what_one_finds(tmp_path):
    values = grid([given_range("timing.tau2=0.001:0.02:12")])
    tables = []
    for count in (1, 2):
        with local_workers(count) as workers:
            tables.append(sweep(order("timing.tau2"), values, tmp_path / str(count), workers).table)
    assert tables[0].equals(tables[1])


@pytest.mark.parametrize("keys", [1, 2, 3])
def test_a_sweep_of_any_number_of_keys_has_a_picture(tmp_path, keys):
    names = ("timing.tau1", "timing.tau2", "actuator.stiffness")[:keys]
    ranges = [given_range(f"{name}={'2,40' if 'stiff' in name else '0.001,0.004'}") for name in names]
    with local_workers(1) as workers:
        done = sweep(order(*names), grid(ranges), tmp_path, workers)
    draw(done.table, ranges, tmp_path / "sweep.svg", drawn=False)
    assert (tmp_path / "sweep.svg").read_text().count("<path") > 10


@pytest.fixture
def cluster(tmp_path):
    """Address of a real scheduler with two real workers, each a process."""
    place = tmp_path / "scheduler.json"
    common = ["--host", "127.0.0.1", "--no-dashboard"]
    start = [sys.executable, "-m", "dask"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": tmp_path}
    started = [
        subprocess.Popen([*start, "scheduler", *common, "--port", "0", "--scheduler-file", place], **quiet)
    ]
    try:
        while not place.exists():
            assert started[0].poll() is None
            time.sleep(0.1)
        worker = [*start, "worker", *common, "--scheduler-file", place, "--nthreads", "1", "--no-nanny"]
        started += [subprocess.Popen(worker, **quiet) for _ in range(2)]
        import json

        from distributed import Client

        address = json.loads(place.read_text())["address"]
        with Client(address) as client:
            client.wait_for_workers(2, timeout=60)
        yield address
    finally:
        for one in started[::-1]:
            one.kill()
            one.wait()


def test_a_dask_cluster_finds_what_this_machine_finds(cluster, tmp_path):
    values = grid([given_range("timing.tau2=0.001:0.02:24")])
    with cluster_workers(cluster) as workers:
        assert workers.count == 2
        there = sweep(order("timing.tau2"), values, tmp_path / "there", workers)
    with local_workers(1) as workers:
        here = sweep(order("timing.tau2"), values, tmp_path / "here", workers)
    assert there.table.equals(here.table)


def test_an_address_where_no_scheduler_answers_is_refused_in_a_sentence(monkeypatch):
    monkeypatch.setattr("rthm_analysis.sweep.workers.CONNECT_S", 0.5)
    with pytest.raises(InputError, match="no Dask scheduler"), cluster_workers("tcp://127.0.0.1:9"):
        pass


def test_a_picture_leaves_out_what_an_unstable_loop_grows_to():
    import pyarrow as pa

    rows = {name: [1.0, 1e14] for name in SHOWN} | {"growth_rate": [-0.1, 2.0]}
    drawn = quantities(pa.table(rows))
    assert drawn["E_err"][0] == 1.0 and np.isnan(drawn["E_err"][1])
    assert drawn["growth_rate"].tolist() == [-0.1, 2.0]


def test_axes_of_pictures_name_the_unit_of_an_entry():
    assert label("timing.tau4") == "timing.tau4 (s)"
    assert label("plant.mass[2]") == "plant.mass[2] (kg)"
    assert label("friction.something") == "friction.something"
