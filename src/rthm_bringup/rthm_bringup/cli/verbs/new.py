"""``rthm new``: a first spec, from a shipped one or from a recording."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rthm_bringup.cli.options import Json

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rthm_analysis.recording import Recording

EXAMPLES = (
    "rthm new mine.yaml",
    "rthm new decay.yaml --like decay",
    "rthm new rig.yaml --from out/bag",
    "rthm new rig.yaml --from decay --mass 1.2",
)


def verb(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="The spec, a file that does not exist yet.")],
    like: Annotated[
        str | None, typer.Option(metavar="NAME", help="Shipped spec to start from; by default paper.")
    ] = None,
    bag: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="BAG",
            help="Recording of a plant alone or of a hybrid test, or a folder from rthm export, to start "
            "from: names, timing and start, and an estimate of mass, damping and stiffness.",
        ),
    ] = None,
    dof: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="With --from: a name that is a dof. Can be repeated."),
    ] = None,
    mass: Annotated[
        list[float] | None,
        typer.Option(
            metavar="KG", help="With --from: weighed mass of a dof; repeated, in the order of the dofs."
        ),
    ] = None,
    json: Json = None,
) -> int:
    """Write a first spec, with unit and meaning of every entry."""
    from rthm_bringup.cli.output import put
    from rthm_core.errors import InputError
    from rthm_core.files import check_new, write_whole
    from rthm_core.spec.first import LIKE, first_spec

    check_new("PATH", path)
    if bag is not None and like is not None:
        raise InputError(
            "--like and --from are both given, but a spec starts from one of them; leave the other out."
        )
    if bag is None and (dof or mass):
        raise InputError("--dof and --mass need a recording; give it with --from, or leave them out.")
    if bag is None:
        write_whole(path, first_spec(like or LIKE))
        put({"spec": str(path), "like": like or LIKE}, [str(path)], json)
        return 0
    text, result, lines = _from_recording(bag, dof or [], mass or [])
    write_whole(path, text)
    put({"spec": str(path), "from": str(bag), **result}, [str(path), *lines], json)
    return 0


def _from_recording(bag: Path, dofs: list[str], masses: list[float]) -> tuple[str, dict[str, Any], list[str]]:
    """Text of the spec, what is told of it as JSON, and in lines."""
    from rthm_analysis.first_spec import draft_of

    with _recording(bag) as recording:
        draft = draft_of(recording, dofs, masses)
        notes = [note for note in recording.notes if "spec" not in note]
        if recording.spec_text:
            notes.append(f"{bag} has a spec of its own, which was not used; rthm export writes it to a file.")
    result = {"figures": [asdict(one) for one in draft.figures], "told": draft.told, "notes": notes}
    return draft.text(str(bag)), result, [*(one.line for one in draft.figures), *draft.told, *notes]


@contextmanager
def _recording(bag: Path) -> Iterator[Recording]:
    """Recording of a bag, or of a folder of files as ``rthm export`` writes them."""
    from tempfile import TemporaryDirectory

    from rthm_analysis.exchange import import_files, wanted
    from rthm_analysis.exchange.topics import FILES
    from rthm_analysis.recording import read_recording

    if not (bag.is_dir() and any(file.stem in FILES for file in bag.iterdir())):
        yield read_recording(bag)
        return
    with TemporaryDirectory() as folder:
        import_files([str(bag)], Path(folder) / "bag", wanted([]))
        yield read_recording(Path(folder) / "bag")
