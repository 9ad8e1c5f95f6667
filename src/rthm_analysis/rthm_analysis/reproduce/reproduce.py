"""`reproduce`: compute everything, write everything."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from rthm_analysis.reproduce import (
    figure02,
    figure07,
    figure08,
    figure09,
    figure10,
    figure11,
    figure12,
    figure13,
    prediction,
    style,
    tables,
)
from rthm_analysis.reproduce.errata import Erratum, all_errata
from rthm_analysis.reproduce.files import write_errata, write_json, write_numbers, write_table
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.page import page
from rthm_core.errors import InputError

PLATES: tuple[Plate, ...] = tuple(
    module.FIGURE
    for module in (
        figure02,
        figure07,
        figure08,
        figure09,
        figure10,
        figure11,
        figure12,
        figure13,
        prediction,
    )
)
TABLES = (tables.table1, tables.table2, tables.table3, tables.sets)


@dataclass(frozen=True)
class Reproduction:
    """Everything that was computed.

    Attributes
    ----------
    numbers : dict of Numbers
        By name of the figure.
    tables : dict of Table
        By name of the table.
    errata : tuple of Erratum
    page : Path
        The page that shows it.
    """

    numbers: dict[str, Numbers]
    tables: dict[str, tables.Table]
    errata: tuple[Erratum, ...]
    page: Path

    def as_dict(self) -> dict[str, object]:
        """For JSON: what was found, without the curves, which are in the CSV files."""
        return {
            "page": str(self.page),
            "figures": {name: {"values": dict(one.values)} for name, one in self.numbers.items()},
            "tables": {name: one.as_dict() for name, one in self.tables.items()},
            "errata": [one.as_dict() for one in self.errata],
        }


def reproduce(
    folder: str | Path, only: Collection[str] = (), progress: Callable[[float], None] | None = None
) -> Reproduction:
    """Write every figure and table of the paper into a folder, and a page that shows them.

    Parameters
    ----------
    folder : str or Path
        Made when it is not there. Pictures (PNG, SVG), numbers (CSV, JSON) and ``index.html``.
    only : collection of str
        Names of the figures to draw, such as ``"figure08"``; none: all of them.
    progress : callable, optional
        Called with the share that is done, 0 to 1.

    Raises
    ------
    InputError
        When the folder cannot be written to, or there is no figure of a name.
    """
    plates, place = _chosen(only), _made(Path(folder))
    told = progress or (lambda done: None)
    numbers: dict[str, Numbers] = {}
    for plate in plates:
        numbers[plate.name] = plate.compute()
        _write_plate(place, plate, numbers[plate.name])
        told(len(numbers) / (len(plates) + 2))
    made = {table.name: table for table in (make() for make in TABLES)}
    for table in made.values():
        write_table(place, table)
    told((len(plates) + 1) / (len(plates) + 2))
    result = Reproduction(numbers, made, all_errata(), place / "index.html")
    write_errata(place, result.errata)
    write_json(place / "numbers.json", result.as_dict())
    result.page.write_text(page(place, plates, numbers, made, result.errata), encoding="utf-8")
    told(1.0)
    return result


def _chosen(only: Collection[str]) -> tuple[Plate, ...]:
    known = [plate.name for plate in PLATES]
    for name in only:
        if name not in known:
            raise InputError(
                f"{name!r} is not a figure, allowed is one of {', '.join(known)}; choose one of them."
            )
    return tuple(plate for plate in PLATES if not only or plate.name in only)


def _made(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as reason:
        raise InputError(
            f"{folder} cannot be made ({reason.strerror}): name a folder that you may write to."
        ) from None
    return folder


def _write_plate(folder: Path, plate: Plate, numbers: Numbers) -> None:
    import matplotlib

    with matplotlib.rc_context(style.LOOK):
        style.save(plate.draw(numbers), folder / plate.name)
    write_numbers(folder, plate.name, numbers)
