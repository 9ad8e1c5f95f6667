"""A recorded test with concealed dry friction, as the examples of the front door expect it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from src.rthm_analysis.test.conftest import rosbag2
from src.rthm_analysis.test.loop import recorded

from rthm import import_table
from rthm_core.spec import apply, shipped_spec

NOISE = {"noise.position": 1e-4, "noise.velocity": 2e-3, "noise.force": 0.02}
RUBBING = {"effects": ["guide"], "guide": {"block": "plant", "kind": "coulomb_friction", "force": 0.1}}


@pytest.fixture(scope="session")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with ``rig/bag``."""
    folder: Path = tmp_path_factory.mktemp("front_door")
    (folder / "rig").mkdir()
    rosbag2(folder / "rig" / "bag", recorded(apply(shipped_spec("paper"), NOISE | RUBBING), 10.0))
    damper(folder)
    return folder


def damper(folder: Path) -> None:
    """Make ``bench/damper``: a damper with dry friction, whose stroke and force were recorded."""
    t = np.arange(0.0, 12.0, 0.005)
    stroke, speed = 0.01 * np.sin(5.0 * t), 0.05 * np.cos(5.0 * t)
    force = 200.0 * speed + 3.0 * np.sign(speed) + 0.05 * np.random.default_rng(3).standard_normal(t.size)
    table = folder / "damper.csv"
    head = "t [s],stroke [m],force [N]"
    np.savetxt(table, np.column_stack([t, stroke, force]), delimiter=",", header=head, comments="")
    (folder / "bench").mkdir()
    import_table(table, folder / "bench" / "damper", {"position:x1": "stroke", "force:a1": "force"})
