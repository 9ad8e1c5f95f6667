"""``rthm stability`` on the command line."""

import json
import subprocess
import sys

import pytest


def rthm(*arguments, status=0):
    done = subprocess.run(
        [sys.executable, "-m", "rthm_bringup", *map(str, arguments)], capture_output=True, text=True
    )
    assert done.returncode == status, done.stderr
    return done


def test_stability_prints_the_keys_of_the_contract():
    found = json.loads(rthm("stability", "paper", "--json", "-").stdout)
    assert found["stable"] is True
    assert found["hyperperiod"] == pytest.approx(0.012)
    assert 0.99 < found["spectral_radius"] < 1.0
    assert found["critical_scale"] == pytest.approx(21.17, abs=0.01)
    assert found["modes"][0]["frequency"] == pytest.approx(2.416, abs=1e-3)
    assert 0.0 < found["modes"][0]["damping_ratio"] < 0.1


def test_stability_of_a_plant_alone_is_one_sentence_and_bad_input():
    done = rthm("stability", "decay", status=2)
    assert done.stderr.count("\n") == 1 and "plant alone" in done.stderr


def test_response_prints_five_ways_for_every_pair_of_dofs():
    done = rthm("response", "paper", "--omega", "1", "--omega", "2:3:3", "--json", "-")
    found = json.loads(done.stdout)["response"]
    assert len(found) == 4 * 4
    assert {one["omega"] for one in found} == {1.0, 2.0, 2.5, 3.0}
    assert found[0]["sampled"]["amplitude"] == pytest.approx(
        found[0]["delays_and_holds"]["amplitude"], rel=0.01
    )


def test_a_frequency_that_is_no_number_is_one_sentence_and_bad_input():
    done = rthm("response", "paper", "--omega", "fast", status=2)
    assert done.stderr.count("\n") == 1 and "fast" in done.stderr


def test_sweep_writes_a_table_and_a_picture_and_goes_on_where_it_was(tmp_path):
    order = ["sweep", "paper", "--set", "timing.tau1=0.001:0.004:4", "--duration", "0", "--workers", "1"]
    first = json.loads(rthm(*order, "-o", tmp_path / "found", "--json", "-").stdout)
    assert first["loops"] == 4 and first["found_before"] == 0
    assert all(row["stable"] for row in first["rows"])
    assert (tmp_path / "found/sweep.parquet").is_file() and (tmp_path / "found/sweep.png").is_file()
    again = json.loads(rthm(*order, "-o", tmp_path / "found", "--json", "-").stdout)
    assert again["found_before"] == 4 and again["rows"] == first["rows"]


def test_a_key_that_the_spec_does_not_know_is_one_sentence_and_bad_input(tmp_path):
    done = rthm("sweep", "--set", "timing.tau9=1:2:3", "-o", tmp_path / "none", status=2)
    assert done.stderr.count("\n") == 1 and "tau9" in done.stderr
