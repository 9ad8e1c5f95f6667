"""``rthm simulate`` writes what the contract promises."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rthm_core.engine import simulate
from rthm_core.spec import apply, shipped_spec, write_spec


@pytest.mark.parametrize("system", ["hybrid", "ideal", "taylor"])
def test_the_file_holds_the_trajectory_of_the_engine(system: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rthm_bringup", "simulate", "paper", "--duration", "0.5"]
    command += ["--sample", "0.01", "--system", system, "--out", str(tmp_path / "a.npz"), "--json", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    expected = simulate(shipped_spec(), 0.5, 0.01, system)
    with np.load(tmp_path / "a.npz") as file:
        assert file["t"].tolist() == expected.t.tolist()
        assert file["t"][[0, -1]].tolist() == [0.0, 0.5]
        assert np.array_equal(file["plant_position"], expected.plant_position)
        assert np.array_equal(file["force_reference"], expected.force_reference)
        assert np.array_equal(file["E_total"], expected.energies["E_total"])
        errors = file["E_num"] + file["E_ff"] + file["E_fx"]
        assert np.allclose(file["E_err"], errors, rtol=0, atol=1e-15)
        assert json.loads(done.stdout)["energies"]["E_total"] == file["E_total"][-1]


def test_the_file_holds_how_the_motion_changes_with_the_numbers_asked_for(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rthm_bringup", "simulate", "paper", "--duration", "0.5"]
    command += ["--sample", "0.01", "--out", str(tmp_path / "a.npz"), "--sensitivity", "plant.mass"]
    subprocess.run(command, capture_output=True, check=True)
    beside = [simulate(apply(shipped_spec(), {"plant.mass": m}), 0.5, 0.01) for m in (1.2 - 1e-5, 1.2 + 1e-5)]
    with np.load(tmp_path / "a.npz") as file:
        change = (beside[1].plant_position - beside[0].plant_position) / 2e-5
        assert np.allclose(
            file["d_plant_position.d_plant.mass"], change, rtol=0, atol=1e-6 * abs(change).max()
        )


def test_sensitivities_of_another_system_are_refused_in_a_sentence(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rthm_bringup", "simulate", "paper", "--duration", "0.5", "--system"]
    command += ["ideal", "--out", str(tmp_path / "a.npz"), "--sensitivity", "plant.mass"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "--system hybrid" in done.stderr
    assert "Traceback" not in done.stderr


def test_what_has_no_recorded_delays_is_refused_in_a_sentence(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rthm_bringup", "simulate", "paper", "--duration", "0.5", "--system"]
    command += ["taylor", "--out", str(tmp_path / "a.npz"), "--as-recorded", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "--as-recorded is for a loop, with --system hybrid" in done.stderr
    assert "Traceback" not in done.stderr


MEASURED = """
import resource, sys
from rthm_bringup.cli.main import application
def peak_after(duration):
    words = ["simulate", "paper", "--duration", duration, "--out", sys.argv[1]]
    application()(words, standalone_mode=False)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(-peak_after("60") + peak_after("3600"))
"""


def test_an_hour_needs_no_more_memory_than_a_minute(tmp_path: Path) -> None:
    out = tmp_path / "hour.npz"
    command = [sys.executable, "-c", MEASURED, str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert out.stat().st_size > 200e6
    assert int(done.stdout.split()[-1]) < 0.1 * out.stat().st_size
    with np.load(out) as file:
        assert file["t"][-1] == pytest.approx(3600.0, abs=1e-9)
        assert file["E_err"].shape == file["t"].shape == (3_000_001,)


def unstable(tmp_path: Path) -> Path:
    file = tmp_path / "unstable.yaml"
    file.write_text(write_spec(apply(shipped_spec(), {"timing.tau2": 0.09})))
    return file


def test_the_verdict_is_told_in_words_and_in_json(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rthm_bringup", "simulate", "paper", "--duration", "20"]
    command += ["--out", str(tmp_path / "a.npz"), "--json", str(tmp_path / "a.json")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    told = json.loads((tmp_path / "a.json").read_text())["verdict"]
    assert told["stable"] and told["delay_margin"] == pytest.approx(21.1688, abs=1e-3)
    assert told["error"]["x1"]["nrmse"] == pytest.approx(0.4475, abs=1e-4)
    error, energy = done.stdout.splitlines()[-2:]
    assert "differs from the ideal system by 44.8 %" in error and "J out of each cycle" in energy
    assert told["energy_per_cycle"] == pytest.approx(-0.0967, abs=1e-4)
    assert not done.stderr


def test_an_unstable_loop_is_told_before_it_is_simulated(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rthm_bringup", "simulate", str(unstable(tmp_path)), "--duration"]
    command += ["20000", "--sample", "0.1", "--out", str(tmp_path / "a.npz")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr.startswith("rthm: Unstable: a small motion doubles every 21.3 s.")
    assert len(done.stderr.splitlines()) == 1
    assert "with tau2 below 78 ms (now 90 ms)" in done.stderr
    assert "Unstable: a small motion doubles every 21.3 s.\n" in done.stdout  # and the way out only once
    assert "nan" not in done.stdout and "diverged" in done.stdout


def test_a_plant_that_leaves_every_bound_is_told_when(tmp_path: Path) -> None:
    effect = {"block": "plant", "kind": "quadratic_stiffness", "dof": "x1", "coefficient": 25.0}
    spec = apply(shipped_spec("decay"), {"effects": ["pull"], "pull": effect, "plant.initial_position": -0.5})
    (tmp_path / "pull.yaml").write_text(write_spec(spec))
    command = [sys.executable, "-m", "rthm_bringup", "simulate", str(tmp_path / "pull.yaml"), "--duration"]
    command += ["5", "--out", str(tmp_path / "a.npz"), "--json", str(tmp_path / "a.json")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    with np.load(tmp_path / "a.npz") as file:
        first = file["t"][~np.isfinite(file["plant_position"][:, 0])][0]
    assert json.loads((tmp_path / "a.json").read_text())["lost_at"] == first
    assert f"The motion diverged at {first:.4g} s; no values after that." in done.stdout


def test_a_mass_that_is_none_on_the_way_is_told(tmp_path: Path) -> None:
    effect = {"block": "plant", "kind": "inertia", "dof": "x1", "mass": "-a * x**2", "a": 40.0}
    spec = apply(
        shipped_spec("decay"),
        {"effects": ["lever"], "lever": effect, "plant.initial_position": 0.0, "plant.initial_velocity": 3.0},
    )
    (tmp_path / "lever.yaml").write_text(write_spec(spec))
    command = [sys.executable, "-m", "rthm_bringup", "simulate", str(tmp_path / "lever.yaml"), "--duration"]
    command += ["5", "--out", str(tmp_path / "a.npz")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "diverged, or its mass matrix was no longer positive definite, at " in done.stdout


def test_an_unstable_loop_does_not_move_a_real_machine_unless_asked_to(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rthm_bringup", "run", str(unstable(tmp_path)), "--plant", "external"]
    done = subprocess.run(
        [*command, "--out", str(tmp_path / "run")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "--unstable" in done.stderr and not (tmp_path / "run").exists()


def test_a_simulation_imports_neither_what_reads_recordings_nor_what_simulates_many(tmp_path: Path) -> None:
    program = (
        "import runpy, sys\n"
        f"sys.argv = ['rthm', 'simulate', 'paper', '--duration', '1', '--out', {str(tmp_path / 'a.npz')!r}]\n"
        "try:\n    runpy.run_module('rthm_bringup', run_name='__main__')\n"
        "except SystemExit:\n    pass\n"
        "print('MODULES', *sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    imported = set(done.stdout.split("MODULES")[1].split())
    assert "rthm_core.engine.simulate" in imported
    assert not imported & {
        "rthm_core.engine.many.ensemble",
        "rthm_analysis.recording",
        "rthm_analysis.lifted.radii",
    }
