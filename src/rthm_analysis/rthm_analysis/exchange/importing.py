"""Files of other tools, or benchmark data, as bags."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rthm_analysis.exchange import topics
from rthm_analysis.exchange.bag import write_bag
from rthm_analysis.exchange.benchmarks import benchmark, benchmark_columns
from rthm_analysis.exchange.columns import Columns
from rthm_analysis.exchange.formats import READERS, read_columns
from rthm_analysis.exchange.mapping import USUAL, Signal, Wanted
from rthm_analysis.exchange.overview import Understood, sampling_words, understood
from rthm_analysis.exchange.signals import plant_tables
from rthm_analysis.recording import LinkTable, Table
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.spec import Spec, read_spec
from rthm_core.topics import PLANT_STATE

SPEC_FILE = "spec.yaml"


@dataclass(frozen=True)
class Imported:
    """One bag that was written.

    Attributes
    ----------
    bag : Path
    samples : int
        Of the plant.
    duration : float
        Seconds.
    names : tuple of str
        Dofs, and what acts on them.
    notes : tuple of str
        What is odd about the data, one sentence each.
    sampling : str
        How often was sampled, in words.
    channels : tuple of Understood
        What each column was taken for; none where the files say it themselves.
    """

    bag: Path
    samples: int
    duration: float
    names: tuple[str, ...]
    notes: tuple[str, ...]
    sampling: str
    channels: tuple[Understood, ...] = ()


def import_files(
    given: Sequence[str],
    out: Path,
    wanted: Wanted,
    spec: Spec | None = None,
) -> list[Imported]:
    """Write bags from files, folders or benchmarks.

    Parameters
    ----------
    given : sequence of str
        Files; or what `export_bag` wrote, as a folder or its files; or names of ``nonlinear_benchmarks``.
    out : Path
        The bag; with several recordings the folder that has one bag for each.
    wanted : Wanted
        Which column is what.
    spec : Spec, optional
        Goes into the bags.

    Raises
    ------
    InputError
        Something cannot be read, does not fit together, or `out` is not empty.
    """
    files = [file for one in given for file in _files(Path(one))]
    if not wanted.signals and files and all(file.stem in topics.FILES for file in files):
        return [_from_topics(files, out, spec)]
    return _each([one for name in given for one in _recordings(name)], out, wanted, spec)


def import_data(data: object, out: Path, wanted: Wanted, spec: Spec | None = None) -> list[Imported]:
    """Write bags from what a function of ``nonlinear_benchmarks`` returned."""
    return _each(benchmark_columns(data, "data"), out, wanted, spec)


def _files(path: Path) -> list[Path]:
    """Files of a folder that belong to topics, or the file itself."""
    if not path.is_dir():
        return [path] if path.suffix.lower() in READERS else []
    found = sorted(
        file for file in path.iterdir() if file.stem in topics.FILES and file.suffix.lower() in READERS
    )
    if not found:
        raise InputError(f"{path} has no files such as plant_state.csv; give files, or a folder from export.")
    return found


def _recordings(name: str) -> list[Columns]:
    path = Path(name)
    if path.suffix or path.exists():
        return [read_columns(path)]
    return benchmark_columns(benchmark(name), name)


def _each(recordings: Sequence[Columns], out: Path, wanted: Wanted, spec: Spec | None) -> list[Imported]:
    places = [out] if len(recordings) == 1 else _places(out, recordings)
    return [_from_columns(one, place, wanted, spec) for one, place in zip(recordings, places, strict=True)]


def _places(out: Path, recordings: Sequence[Columns]) -> list[Path]:
    names = [re.sub(r"\W+", "_", Path(one.source).stem).strip("_") or "data" for one in recordings]
    return [out / (f"{name}_{k + 1}" if names.count(name) > 1 else name) for k, name in enumerate(names)]


def _from_columns(columns: Columns, bag: Path, wanted: Wanted, spec: Spec | None) -> Imported:
    if not wanted.signals and {"u", "y"} <= set(columns.values):
        wanted = replace(wanted, signals=_input_and_output(spec))
    tables, notes = plant_tables(columns, wanted, spec)
    written = _written(bag, tables, {}, spec.expanded() if spec else "", notes)
    names = tuple(dict.fromkeys(name for table in tables.values() for name in table.names))
    return replace(written, names=names, channels=tuple(understood(columns, wanted, tables)))


def _input_and_output(spec: Spec | None) -> tuple[Signal, ...]:
    """Signals of a benchmark: force u and position y."""
    dof = spec.plant.dofs[0] if spec and spec.plant else USUAL[True]
    actuator = spec.actuator.names[0] if spec and spec.actuator else USUAL[False]
    return Signal("position", dof, "y"), Signal("force", actuator, "u")


def _from_topics(files: Sequence[Path], bag: Path, spec: Spec | None) -> Imported:
    tables: dict[str, Table] = {}
    links: dict[str, LinkTable] = {}
    for file in files:
        columns, name = read_columns(file), topics.FILES[file.stem]
        if name in tables or name in links:
            raise InputError(f"{file} is there in another format as well; leave one of them.")
        if file.stem.startswith("links_"):
            links[name] = topics.link_table(columns)
        else:
            tables[name] = topics.state_table(columns)
    if PLANT_STATE not in tables:
        raise InputError(f"{files[0].parent} has no plant_state, which every recording needs; add that file.")
    beside = files[0].parent / SPEC_FILE
    text = spec.expanded() if spec else ""
    if not text and beside.is_file():
        text = beside.read_text(encoding="utf-8")
        read_spec(text)
    return _written(bag, tables, links, text, [])


def _written(
    bag: Path, tables: dict[str, Table], links: dict[str, LinkTable], spec_text: str, notes: list[str]
) -> Imported:
    if not spec_text:
        notes = [*notes, "there is no spec in the bag: give one with --spec, here or to rthm diagnose."]
    write_bag(bag, tables, links, spec_text)
    plant = tables[PLANT_STATE]
    duration = float(plant.stamp_ns[-1] - plant.stamp_ns[0]) / NS if len(plant) else 0.0
    return Imported(bag, len(plant), duration, plant.names, tuple(notes), sampling_words(plant))
