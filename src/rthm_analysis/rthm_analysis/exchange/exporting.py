"""A recording as files of other tools."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.exchange.columns import Column, Columns
from rthm_analysis.exchange.formats import WRITERS, write_columns
from rthm_analysis.exchange.importing import SPEC_FILE
from rthm_analysis.exchange.topics import INSTANTS, columns_by_file, state_columns
from rthm_analysis.recording import Recording, hold
from rthm_core.clock import NS
from rthm_core.errors import InputError, refusal

if TYPE_CHECKING:
    from rthm_core.compiled import Integers

MOST_ROWS = 50_000_000


def export_bag(recording: Recording, out: Path, form: str = "csv", rate: float | None = None) -> list[Path]:
    """Write a recording, and return the files.

    Parameters
    ----------
    recording : Recording
    out : Path
        With the ending of a format: one table, in which every signal is held between its samples. Else a
        folder: one file for each topic, every sample as it is, and the spec.
    form : str
        Format of the files of a folder: csv, mat or parquet.
    rate : float, optional
        Rows per second of the one table; by default it has the instants of ``plant/state``.

    Raises
    ------
    InputError
        There is no such format, or a file would be overwritten.
    """
    if out.suffix.lower() in WRITERS:
        files = {out: held_columns(recording, _instants(recording, rate))}
    elif out.suffix and not out.is_dir():
        raise InputError(
            f"{out} ends in {out.suffix}, but one table is written as {', '.join(WRITERS)}, and a folder of "
            "tables has no ending; name one of these."
        )
    elif rate is not None:
        raise InputError(
            f"--rate {rate:g} makes one table, so {out} must end in {', '.join(WRITERS)}; name it."
        )
    elif f".{form}" not in WRITERS:
        raise refusal("--format", form, f"one of {', '.join(one[1:] for one in WRITERS)}")
    else:
        files = {out / f"{name}.{form}": columns for name, columns in columns_by_file(recording).items()}
    spec = out / SPEC_FILE
    texts = {spec: recording.spec_text} if out not in files and recording.spec_text else {}
    for place in (*files, *texts):
        if place.exists():
            raise InputError(f"{place} is there already, and nothing is overwritten; give another name.")
    for place, columns in files.items():
        write_columns(place, columns)
    for place, text in texts.items():
        place.write_text(text, encoding="utf-8")
    return [*files, *texts]


def held_columns(recording: Recording, at: Integers) -> Columns:
    """One table of all topics, held: time in s from the start, then ``TOPIC/NAME.field``.

    Before the first sample of a topic its values are missing.
    """
    values: dict[str, Column] = {"time": (at - recording.start_ns) / NS}
    units = {"time": "s"}
    for topic, table in recording.tables.items():
        known = at >= table.stamp_ns[0]
        columns, told = state_columns(table, topic)
        for name, column in columns.items():
            if name in INSTANTS:
                continue
            values[f"{topic}/{name}"] = np.where(known, hold(table.stamp_ns, column, at), np.nan)
            units[f"{topic}/{name}"] = told[name]
    return Columns(str(recording.path), values, units)


def _instants(recording: Recording, rate: float | None) -> Integers:
    if rate is None:
        return recording.plant.stamp_ns
    rows = recording.duration * rate + 1.0
    if not 0.0 < rate <= 1e7 or rows > MOST_ROWS:
        raise refusal("--rate", rate, f"above 0 and up to 1e7 Hz, with at most {MOST_ROWS} rows")
    return np.asarray(
        recording.start_ns + np.rint(np.arange(int(rows + 1e-9)) * (NS / rate)).astype(np.int64)
    )
