"""Arguments that several verbs share."""

from __future__ import annotations

from glob import escape, glob
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.spec import Spec

Json = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="PATH",
        help="Write the result as JSON; - is standard output.",
        callback=lambda path: _checked_json(path),
    ),
]


def _checked_json(path: str | None) -> str | None:
    from rthm_core.files import check_place

    if path not in (None, "-"):
        check_place("--json", str(path))
    return path


def _spec_names(incomplete: str) -> list[str]:
    """What a shell offers for the beginning of a spec's name: shipped specs, and files here."""
    from rthm_core.spec import shipped_names

    shipped = [name for name in shipped_names() if name.startswith(incomplete)]
    return shipped + sorted(glob(f"{escape(incomplete)}*.y*ml"))


SpecName = Annotated[
    str,
    typer.Argument(
        metavar="[SPEC]", help="A spec file, or the name of a shipped one.", autocompletion=_spec_names
    ),
]
Amplitude = Annotated[
    float, typer.Option(metavar="A", help="Factor on loads and initial motion, such as 0.1 for a first try.")
]
Wait = Annotated[float, typer.Option(metavar="S", help="How long to wait for a sample.", min=0.0, max=3600.0)]
Effects = Annotated[
    list[str] | None,
    typer.Option(
        "--effects",
        metavar="FILE",
        help="Python file that declares kinds of effects; it is executed. Can be repeated.",
    ),
]
SpecOfBag = Annotated[
    str | None,
    typer.Option(
        "--spec",
        metavar="SPEC",
        help="Spec of the test; by default that in the recording.",
        autocompletion=_spec_names,
    ),
]
Yes = Annotated[bool, typer.Option("--yes", "-y", help="Announce hours of work, but do not ask.")]
PICTURES = (".png", ".svg", ".pdf")
"""Endings of a picture."""

Bag = Annotated[Path, typer.Argument(metavar="BAG", help="A recording: its folder or file.")]
Bags = Annotated[
    list[Path],
    typer.Argument(
        metavar="BAG...",
        help="A recording, or several of one rig: the last confirms what the others show.",
    ),
]


def check_picture(path: Path) -> None:
    """Refuse a name that no picture can have."""
    from rthm_core.errors import InputError

    if path.suffix.lower() not in PICTURES or not path.parent.is_dir():
        raise InputError(
            f"{path} is not a name for a picture, which must end in {', '.join(PICTURES)} and lie in a "
            "folder that is there; correct it."
        )


def spec_named(name: str, effects: list[str] | None = None) -> Spec:
    """Read the spec that an argument names: a file, else a shipped spec; `effects` as the option gives them.

    Raises
    ------
    InputError
        If it is neither, or not a spec.
    """
    from rthm_core.spec import spec_at

    return spec_at(name, effects or ())


def recording_of(bag: Path, effects: list[str] | None = None, spec: str | None = None) -> Recording:
    """Read a recording, whose spec may have effects of one's own; `spec` stands in for that spec."""
    from rthm_analysis.recording import read_recording, with_spec
    from rthm_core.effects import load_effects

    load_effects(effects or ())
    return with_spec(read_recording(bag), spec or None)
