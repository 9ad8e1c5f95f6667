"""``rthm response``: from a load on one dof to the motion of another."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rthm_bringup.cli.options import Json, SpecName

if TYPE_CHECKING:
    from rthm_analysis.response import Response
    from rthm_core.spec import Spec

EXAMPLES = (
    "rthm response paper --omega 0.5:20:40",
    "rthm response paper --omega 0.5:20:400 --plot bode.svg",
)


def verb(
    omega: Annotated[
        list[str],
        typer.Option("--omega", metavar="W", help="Frequency in rad/s, or a:b:n; can be repeated."),
    ],
    spec: SpecName = "paper",
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Also draw amplitude and phase, as .png, .svg or .pdf."),
    ] = None,
    json: Json = None,
) -> int:
    """Compute the frequency response of a loop and its margins.

    Beside the sampled loop: the ideal system, and the loop with its delays alone. Gain, phase and delay
    margin are those of the loop opened at the command of each motor.
    """
    import numpy as np

    from rthm_analysis.response import response
    from rthm_analysis.sweep.ranges import numbers
    from rthm_bringup.cli.options import check_picture, spec_named
    from rthm_bringup.cli.output import put

    frequencies = np.concatenate([numbers(text)[0] for text in omega])
    test = spec_named(spec)
    if plot is not None:
        check_picture(plot)
    result = response(test, frequencies)
    if plot is not None:
        _draw(test, result, plot)
    drawn, lines = ({}, []) if plot is None else ({"picture": str(plot)}, ["", str(plot)])
    put(result.as_dict() | drawn, [*_lines(result), *lines], json)
    return 0


def _draw(test: Spec, result: Response, plot: Path) -> None:
    from rthm_analysis.outcome import Margin
    from rthm_analysis.outcome.margin import margin_or_why
    from rthm_analysis.response.picture import draw

    margin = margin_or_why(test)
    draw(result, margin.words if isinstance(margin, Margin) else margin, plot)


def _lines(result: Response) -> list[str]:
    from rthm_analysis.response import WAYS
    from rthm_bringup.cli.output import table

    rows = [("load on, motion of", "rad/s", *(way.replace("_", " ") for way in WAYS))]
    told: Any = result.as_dict()["response"]
    for one in told:
        cells = [f"{one[way]['amplitude']:.5g} m/N {one[way]['phase_deg']:+.2f} deg" for way in WAYS]
        rows.append((f"{one['input']}, {one['output']}", f"{one['omega']:g}", *cells))
    unstable = (
        []
        if result.stable
        else ["the sampled loop is unstable: its column describes no motion that it settles to."]
    )
    return [*result.left_out, *unstable, *table(rows), "", *table(_margins(result))]


def _margins(result: Response) -> list[tuple[str, ...]]:
    head = ("loop opened at command of", "gain margin", "phase margin", "delay margin")
    return [head, *((one.actuator, *one.words) for one in result.margins)]
