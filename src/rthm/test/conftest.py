"""A recorded test with concealed dry friction, as the examples of the front door expect it."""

from __future__ import annotations

from pathlib import Path

import pytest
from benchmarks.concealed.case import make_case


@pytest.fixture(scope="session")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with ``rig/bag``."""
    folder: Path = tmp_path_factory.mktemp("front_door")
    make_case(72, (("plant", "coulomb_friction"),), 0.05, folder / "rig", duration=20.0)
    return folder
