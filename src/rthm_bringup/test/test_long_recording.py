"""Ten minutes at 1 kHz: how much memory a diagnosis takes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.io import savemat

DURATION, RATE = 600.0, 1000.0
MASS, DAMPING, STIFFNESS = 1.2, 0.05, 12.0
NOISE = (1e-4, 2e-3)
SPEC = f"""
/**:
  ros__parameters:
    plant:
      dofs: ["x1"]
      mass: [{MASS}]
      damping: [{DAMPING}]
      stiffness: [{STIFFNESS}]
      initial_position: [0.0]
      initial_velocity: [0.0]
"""
MEASURED = """
import resource, sys
from rthm_bringup.cli.main import application
application()(["diagnose", sys.argv[1], "--json", sys.argv[2]], standalone_mode=False)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


def rig(folder: Path) -> Path:
    """Table of a plant under a known force, with magnets along its way that no kind of the library is."""
    rng = np.random.default_rng(7)
    omega, phase = np.sort(rng.uniform(0.5, 8.0, 18)), rng.uniform(0.0, 2.0 * np.pi, 18)

    def load(t: np.ndarray) -> np.ndarray:
        return np.minimum(t / 2.0, 1.0) * 0.2 * sum(map(np.sin, np.multiply.outer(omega, t) + phase[:, None]))

    def rate(t: float, y: np.ndarray) -> list[float]:
        magnets = 0.1 * np.sin(2.0 * np.pi * y[0] / 0.07)
        known = 0.2 * min(t / 2.0, 1.0) * np.sin(omega * t + phase).sum()
        return [y[1], (known - DAMPING * y[1] - STIFFNESS * y[0] + magnets) / MASS]

    time = np.arange(int(DURATION * RATE) + 1) / RATE
    done = solve_ivp(rate, (0.0, DURATION), [0.0, 0.0], "DOP853", time, rtol=1e-8, atol=1e-9)
    x, v = done.y + rng.normal(size=done.y.shape) * np.array(NOISE)[:, None]
    savemat(folder / "rig.mat", {"t": time, "x": x, "v": v, "w": load(time)})
    (folder / "spec.yaml").write_text(SPEC)
    return folder / "rig.mat"


@pytest.mark.long
def test_ten_minutes_at_1_khz_take_less_than_a_gib_and_a_half(tmp_path: Path) -> None:
    bag, told = str(tmp_path / "bag"), tmp_path / "told.json"
    command = [sys.executable, "-m", "rthm_bringup", "import", str(rig(tmp_path)), "-o", bag, "--time", "t"]
    command += ["--map", "position:x1=x", "--map", "velocity:x1=v", "--map", "load:x1=w"]
    subprocess.run([*command, "--spec", str(tmp_path / "spec.yaml")], check=True, capture_output=True)
    measured = [sys.executable, "-c", MEASURED, bag, str(told)]
    done = subprocess.run(measured, check=True, capture_output=True, text=True)
    assert int(done.stdout.split()[-1]) < 1.5 * 2**30
    found = json.loads(told.read_text())
    assert found["verdict"] == "explained"
    assert [one["formula"].count("sin(2 * pi * x / 0.07") for one in found["described"]] == [1]
