"""A trajectory as a file, written while it is simulated."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from rthm_bringup.cli.pace import bytes_words
from rthm_core.clock import to_ns
from rthm_core.energy import TERMS
from rthm_core.errors import InputError
from rthm_core.files import not_written

if TYPE_CHECKING:
    from rthm_core.engine import Trajectory
    from rthm_core.spec import Spec

MOTION = (
    "t",
    "plant_position",
    "plant_velocity",
    "numerical_position",
    "numerical_velocity",
    "force_reference",
    "actuator_force",
)
"""Arrays beside the energies; one row per instant, one column per degree of freedom or actuator."""


ENERGIES = len(TERMS) + 2
"""Energies beside the motion, each a column: of every term, and their two sums."""


class TrajectoryFile:
    """Npz file with the keys of the contract, section 5, from blocks of rows that need not be kept.

    In an npz file an array is in one piece, and its length comes first. So the arrays grow in files of their
    own, and are put together in the end.

    Attributes
    ----------
    energies : dict
        Energies of the last row, J.
    """

    def __init__(self, folder: Path) -> None:
        self.energies: dict[str, float] = {}
        self._folder = folder
        self._shapes: dict[str, tuple[int, ...]] = {}

    def add(self, block: Trajectory) -> None:
        """Append the rows of a block."""
        energies = block.all_energies()
        for name, values in ({name: getattr(block, name) for name in MOTION} | energies).items():
            rows, *width = self._shapes.get(name, (0, *values.shape[1:]))
            self._shapes[name] = (rows + len(values), *width)
            with (self._folder / name).open("ab") as column:
                column.write(values.tobytes())
        self.energies = {name: float(values[-1]) for name, values in energies.items()}

    def add_change(self, name: str, change: Trajectory) -> None:
        """Append the derivative of the motion with respect to a number of the spec, as
        ``d_plant_position.d_plant.mass``.
        """
        for signal in MOTION[1:]:
            values = getattr(change, signal)
            column = f"d_{signal}.d_{name}"
            self._shapes[column] = values.shape
            (self._folder / column).write_bytes(np.ascontiguousarray(values).tobytes())

    def put_together(self, path: Path) -> None:
        """Write the file."""
        from numpy.lib import format as npy

        with zipfile.ZipFile(path, "w") as archive:
            for name, shape in self._shapes.items():
                head = {"descr": "<f8", "fortran_order": False, "shape": shape}
                with (
                    (self._folder / name).open("rb") as column,
                    archive.open(f"{name}.npy", "w", force_zip64=True) as member,
                ):
                    npy.write_array_header_1_0(member, head)
                    shutil.copyfileobj(column, member, 1 << 20)


@contextmanager
def _one_sentence(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise not_written(path, error) from error


def check_room(path: Path, spec: Spec, duration: float, sample: float | None) -> None:
    """Refuse a trajectory for which its disk has no room, before hours of work.

    Raises
    ------
    InputError
        If its rows, each twice until they are put together, need more than is free.
    """
    from rthm_core.engine.simulate import checked_step

    step = checked_step(spec, duration, sample)
    rows = to_ns(duration) // step + 1
    sides = [side for side in (spec.plant, spec.numerical) if side]
    columns = 1 + ENERGIES + sum(2 * len(side.dofs) for side in sides) + 2 * len(spec.k_tot)
    needed, (total, _, free) = 2 * 8 * rows * columns, shutil.disk_usage(path.parent)
    if needed > free and total:
        raise InputError(
            f"A trajectory of {rows:.3g} rows needs {bytes_words(needed)} while it is written, but "
            f"{path.parent} has {bytes_words(free)} free; take a larger --sample, a shorter --duration or "
            "another disk."
        )


@contextmanager
def trajectory_file(path: Path) -> Iterator[TrajectoryFile]:
    """Open a trajectory for writing; the file is there when it is complete."""
    with _one_sentence(path), TemporaryDirectory(prefix=f".{path.name}", dir=path.parent) as folder:
        file = TrajectoryFile(Path(folder))
        yield file
        whole = Path(folder) / "whole.npz"
        file.put_together(whole)
        whole.replace(path)
