"""Results as text and as JSON."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rthm_bringup.cli.colour import coloured, is_coloured
from rthm_bringup.cli.pace import Pace, asked, told
from rthm_core.files import write_whole

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def put(result: Mapping[str, Any], lines: Iterable[str], path: str | None) -> None:
    """Print `lines` and write `result` to a JSON path; with ``-`` the JSON is all that is printed."""
    if path != "-":
        print(*(coloured(lines) if is_coloured() else lines), sep="\n")
    if path is None:
        return
    text = json.dumps(plain(result), indent=1, allow_nan=False, ensure_ascii=False) + "\n"
    if path == "-":
        sys.stdout.write(text)
    else:
        write_whole(path, text)


def put_spec(
    spec: Spec, file: Path, why: str, result: Mapping[str, Any], lines: Iterable[str], path: str | None
) -> int:
    """Write a spec and report `result` with it, or why there is none; return the exit status."""
    from rthm_core.spec import write_spec

    if not why:
        write_whole(file, write_spec(spec))
    whole = {**result, "spec": None if why else str(file), "problem": why or None}
    put(whole, [*lines, why or f"spec:   {file}"], path)
    return int(bool(why))


def plain(value: Any) -> Any:
    """Return the value in the types of JSON; what is not finite becomes null."""
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, str | int | bool) or value is None:
        return value
    if isinstance(value, Iterable):
        return [plain(one) for one in value]
    return str(value)


@contextmanager
def progress_bar(
    words: str,
    total: float,
    size: Callable[[float], str] | None = None,
    *,
    yes: bool = False,
    resumes: bool = False,
) -> Iterator[Callable[[float], None]]:
    """Bar on standard error, if that is a terminal; give it how much is done.

    What will take hours is announced (`pace`) with its `size`; without `yes` it is asked about, too.
    """
    if not sys.stderr.isatty():
        yield Pace(total, told if yes else asked, size=size, resumes=resumes).told
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(words, total=total)

        def ask(sentence: str) -> bool:
            bar.stop()  # the bar and the question share a line
            answer = (told if yes else asked)(sentence)
            bar.start()
            return answer

        pace = Pace(total, ask, size=size, resumes=resumes)

        def report(done: float) -> None:
            bar.update(task, completed=done)
            pace.told(done)

        yield report


@contextmanager
def status(words: str) -> Iterator[Callable[[str], None]]:
    """What is being done, on standard error, if that is a terminal; what it gives hears what comes next."""
    if not sys.stderr.isatty():
        yield lambda said: None
        return
    from rich.console import Console

    with Console(stderr=True).status(words) as line:
        yield lambda said: line.update(said)


def table(rows: Iterable[tuple[str, ...]]) -> list[str]:
    """Lines with the columns of the rows under each other; the first column is left, the others right."""
    kept = list(rows)
    if not kept:
        return []
    widths = [max(map(len, column)) for column in zip(*kept, strict=True)]
    return [
        "  ".join(
            [row[0].ljust(widths[0]), *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))]
        )
        for row in kept
    ]
