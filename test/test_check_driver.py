"""``rthm check-driver`` at a driver of somebody else, right and wrong."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from rthm_core.spec import apply, shipped_spec, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
DRIVER = Path(__file__).parent / "programs" / "driver.py"
CHECK = [sys.executable, "-m", "rthm_bringup", "check-driver"]


@pytest.fixture
def patient(tmp_path: Path) -> str:
    """Path of a spec whose links are slow enough for any host that is busy with other tests."""
    path = tmp_path / "spec.yaml"
    path.write_text(write_spec(apply(shipped_spec(), {"timing.tau1": 0.5, "timing.tau2": 0.5})))
    return str(path)


def checked(driver: Path, environment: dict[str, str], *options: str) -> tuple[int, dict[str, Any]]:
    """Exit status and the checks by name."""
    with subprocess.Popen([sys.executable, str(driver), "600"], env=environment) as running:
        done = subprocess.run(
            [*CHECK, *options, "--json", "-"], env=environment, capture_output=True, text=True, check=False
        )
        running.terminate()
    assert done.stderr == ""
    return done.returncode, {one["name"]: one for one in json.loads(done.stdout)["checks"]}


def test_a_right_driver_passes_and_its_motor_follows(environment: dict[str, str], patient: str) -> None:
    status, checks = checked(DRIVER, environment, patient, "--seconds", "6", "--swing", "0.02")
    assert [one["words"] for one in checks.values() if not one["passed"]] == []
    assert status == 0
    assert checks["samples"]["value"] > 4500
    assert checks["period"]["value"] == pytest.approx(1.2e-3, rel=1e-6)
    assert "/rthm/driver" in checks["one publisher"]["words"]


def test_stamps_in_whole_milliseconds_and_another_delivery_are_found(
    environment: dict[str, str], patient: str, tmp_path: Path
) -> None:
    text = DRIVER.read_text()
    for right, wrong in (
        ("divmod(due, 10**9)", "divmod(due // 10**6 * 10**6, 10**9)"),
        ("QoSProfile(depth=1000)", "rclpy.qos.qos_profile_sensor_data"),
    ):
        assert text.count(right) == 1
        text = text.replace(right, wrong)
    driver = tmp_path / "driver.py"
    driver.write_text(text)
    status, checks = checked(driver, environment, patient, "--seconds", "1")
    assert status == 1
    assert not checks["clock grid"]["passed"] and not checks["reliable"]["passed"]
    # cut to 1 ms, ticks of 1.2 ms are off by 0, 0.2, ... 0.8 ms: 0.4 ms either way from the grid between them
    assert checks["clock grid"]["value"] == pytest.approx(4e-4, rel=0.01)
    assert checks["names"]["passed"] and checks["stamps increase"]["passed"]
