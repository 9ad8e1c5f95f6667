"""A recorded test with concealed dry friction, as the examples of the front door expect it."""

from __future__ import annotations

from pathlib import Path

import pytest
from src.rthm_analysis.test.conftest import rosbag2
from src.rthm_analysis.test.loop import recorded

from rthm_core.spec import apply, shipped_spec

NOISE = {"noise.position": 1e-4, "noise.velocity": 2e-3, "noise.force": 0.02}
RUBBING = {"effects": ["guide"], "guide": {"block": "plant", "kind": "coulomb_friction", "force": 0.1}}


@pytest.fixture(scope="session")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with ``rig/bag``."""
    folder: Path = tmp_path_factory.mktemp("front_door")
    (folder / "rig").mkdir()
    rosbag2(folder / "rig" / "bag", recorded(apply(shipped_spec("paper"), NOISE | RUBBING), 10.0))
    return folder
