"""What a run left in its folder: recording, report, spec."""

from __future__ import annotations

import json
import math
from datetime import datetime
from html import unescape
from pathlib import Path
from typing import Any

import yaml

from rthm_analysis.runs.index import Run
from rthm_core.clock import EARLIEST_YEAR, NS
from rthm_core.errors import InputError
from rthm_core.spec import Spec, read_spec, shipped_names, shipped_spec
from rthm_core.spec.parameters import values

CHANGES = 2
"""Changed entries that are told of a spec."""


def is_run(place: Path) -> bool:
    """Whether a folder is that of a run: it has a recording, or what a run writes before there is one."""
    begun = (place / "spec.yaml").is_file() and (place / "log").is_dir()
    return begun or (place / "bag").is_dir()


def read_run(folder: Path) -> Run:
    """Tell what a run left; what is missing or damaged is a problem."""
    bag, page, problems = _bag(folder), _page(folder), []
    verdict, timing = page.get("verdict"), page.get("timing")
    aborted = page.get("abort")
    if not bag:
        problems.append("The recording is missing or incomplete.")
    if not page:
        problems.append("There is no report; rthm report writes one.")
    problems += [aborted] if aborted else []
    problems += _losses(bag, timing)
    error = {
        dof: float(one["nrmse"]) for dof, one in _part(verdict, "error").items() if one["nrmse"] is not None
    }
    spec, why = _spec(folder)
    problems += why
    outcome = "aborted" if aborted else _outcome(page, verdict)
    return Run(folder.name, folder, spec, _begun(folder, bag), _length(bag), outcome, error, tuple(problems))


def _part(result: Any, key: str) -> dict[str, Any]:
    return (result or {}).get(key) or {}


def _outcome(page: dict[str, Any], verdict: Any) -> str:
    if not page:
        return "no report"
    stable = (verdict or {}).get("stable")
    return "not judged" if stable is None else "stable" if stable else "unstable"


def _bag(folder: Path) -> dict[str, Any]:
    """Content of metadata.yaml; empty where there is none, or a damaged one."""
    try:
        content = yaml.safe_load((folder / "bag" / "metadata.yaml").read_text(encoding="utf-8"))
        found = content["rosbag2_bagfile_information"]
        return found if isinstance(found, dict) else {}
    except (OSError, UnicodeDecodeError, yaml.YAMLError, LookupError, TypeError):
        return {}


def _page(folder: Path) -> dict[str, Any]:
    """Results in the report, by the names of its elements, and the sentence of an abort."""
    try:
        text = (folder / "report.html").read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return {}
    found = {
        name: _element(text, f'<script type="application/json" id="{name}">', "</script>")
        for name in ("timing", "verdict")
    }
    results: dict[str, Any] = {}
    for name, content in found.items():
        try:
            results[name] = json.loads(content) if content else None
        except ValueError:
            results[name] = None
    return results | {"abort": unescape(_element(text, '<p class="abort">', "</p>"))}


def _element(text: str, begin: str, end: str) -> str:
    first = text.find(begin)
    return "" if first < 0 else text[first + len(begin) : text.find(end, first)]


def _losses(bag: dict[str, Any], timing: Any) -> list[str]:
    """Samples that were lost or late, ticks that were missed."""
    counts = bag.get("custom_data") or {}
    said = []
    lost = str(counts.get("lost", "0"))
    if lost.isdecimal() and int(lost):
        said.append(f"{lost} samples were lost on the way to the recorder.")
    for what in ("lost", "late"):
        where = {name: one[what] for name, one in _part(timing, "links").items() if one.get(what)}
        if where:
            links = ", ".join(f"{name} {count}" for name, count in where.items())
            said.append(f"Samples {what} on links: {links}.")
    missed = sum(one.get("missed") or 0 for one in _part(timing, "clocks").values())
    return [*said, f"{missed} deadlines were missed."] if missed else said


def _begun(folder: Path, bag: dict[str, Any]) -> datetime:
    """When the recording began; where its time is simulated, when its folder was written."""
    told = (bag.get("starting_time") or {}).get("nanoseconds_since_epoch")
    if isinstance(told, int) and datetime.fromtimestamp(told / NS).year > EARLIEST_YEAR:
        return datetime.fromtimestamp(told / NS)
    first = folder / "spec.yaml" if (folder / "spec.yaml").is_file() else folder
    return datetime.fromtimestamp(first.stat().st_mtime)


def _length(bag: dict[str, Any]) -> float:
    told = (bag.get("duration") or {}).get("nanoseconds")
    return told / NS if isinstance(told, int) else math.nan


def _spec(folder: Path) -> tuple[str, list[str]]:
    file = folder / "spec.yaml"
    if not file.is_file():
        return "", []
    try:
        return spec_words(read_spec(file)), []
    except InputError as reason:
        return "", [str(reason)]


def spec_words(spec: Spec) -> str:
    """Name of the shipped spec that a spec is, or is most like, with what is changed.

    Examples
    --------
    >>> from rthm_core.spec import apply
    >>> spec_words(apply(shipped_spec("paper"), {"timing.tau4": 0.03}))
    'paper, timing.tau4 0.03'
    """
    own = values(spec)
    changes = {name: _changes(own, values(shipped_spec(name))) for name in shipped_names()}
    name = min(changes, key=lambda one: len(changes[one]))
    if len(changes[name]) > CHANGES:
        return f"like {name}, {len(changes[name])} entries changed"
    told = [f"{key} {'left out' if value is None else _plain(value)}" for key, value in changes[name].items()]
    return ", ".join([name, *told])


def _changes(own: dict[str, Any], other: dict[str, Any]) -> dict[str, Any]:
    return {key: own.get(key) for key in own | other if own.get(key) != other.get(key)}


def _plain(value: Any) -> str:
    if isinstance(value, list):
        return " ".join(map(_plain, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def read_trajectory_file(file: Path) -> Run:
    """Tell of a trajectory that `rthm simulate` wrote: its length, from its times alone."""
    import numpy as np

    begun = datetime.fromtimestamp(file.stat().st_mtime)
    try:
        with file.open("rb") as stream, np.load(stream, allow_pickle=False) as arrays:
            duration, problems = float(arrays["t"][-1]), ()
    except Exception as reason:  # whatever a damaged archive may raise
        return Run(
            file.name, file, "", begun, math.nan, "not judged", {}, (f"It cannot be read ({reason}).",)
        )
    return Run(file.name, file, "", begun, duration, "not judged", {}, problems)
