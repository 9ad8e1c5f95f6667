"""``rthm stability``: exact stability of the sampled loop."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rthm_bringup.cli.options import Json, SpecName

if TYPE_CHECKING:
    from rthm_analysis.stability import Stability
    from rthm_core.spec import Spec

EXAMPLES = (
    "rthm stability paper",
    "rthm stability paper --map timing.tau4=0:0.03:40 actuator.stiffness=5:50:40 --out map.svg",
)


def verb(
    spec: SpecName = "paper",
    over: Annotated[
        tuple[str, str] | None,
        typer.Option(
            "--map",
            metavar="KEY=A:B:N KEY=A:B:N",
            help="Also draw the growth rate over two entries of the spec; timing.scale is a factor on all "
            "periods and delays.",
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE", help="Picture of the map: .png, .svg or .pdf.")
    ] = Path("stability.png"),
    limits: Annotated[
        bool,
        typer.Option(
            "--limits/--no-limits",
            help="Search for the limits of every period, delay and k_tot, or judge only the spec itself.",
        ),
    ] = True,
    json: Json = None,
) -> int:
    """Judge the stability of a loop: modes, and limits of every delay."""
    from rthm_analysis.stability import stability
    from rthm_analysis.stability.analysis import SEARCHES
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import progress_bar, put

    test = spec_named(spec)
    drawn = _map(test, over, out) if over else {}
    with progress_bar("searching for limits", SEARCHES) as report:
        result = stability(test, limits=limits, progress=report)
    put(result.as_dict() | drawn, [*_lines(result), *(["", str(out)] if drawn else [])], json)
    return 0


def _map(test: Spec, over: tuple[str, str], out: Path) -> dict[str, object]:
    from rthm_analysis.stability.map import stability_map
    from rthm_analysis.stability.picture import draw
    from rthm_analysis.sweep.points import check_ends, value_of
    from rthm_analysis.sweep.ranges import given_range
    from rthm_bringup.cli.options import check_picture
    from rthm_bringup.cli.output import progress_bar

    check_picture(out)
    first, second = (given_range(text) for text in over)
    check_ends(test, [first, second])
    with progress_bar("map", first.values.size) as report:
        found = stability_map(test, (first, second), report)
    draw(found, (value_of(test, first.key), value_of(test, second.key)), out)
    return {"map": found.as_dict() | {"picture": str(out)}}


def _lines(result: Stability) -> list[str]:
    from rthm_bringup.cli.output import table

    radius = f"largest eigenvalue {result.spectral_radius:.9f} over {result.hyperperiod * 1e3:.6g} ms"
    head = [f"{'stable' if result.stable else 'not stable'}: {radius}"]
    if result.period_error:
        head.append(
            "clocks without a common period: computed with the nearest periods that have one, off by "
            f"{result.period_error:.1e}"
        )
    modes = [("mode", "frequency", "damping ratio")]
    for number, mode in enumerate(result.modes, 1):
        modes.append((str(number), f"{mode.frequency:.6g} rad/s", f"{mode.damping_ratio:+.6f}"))
    limits = [("limit", "in the spec", "stability first lost at", "crossings", "searched to")]
    for name, limit in result.limits.items():
        unit = 1e3 if name.startswith("t") else 1.0
        value = limit.critical_value
        limits.append(
            (
                name if name != "scale" else "all delays",
                _number(limit.nominal * unit, unit),
                "-" if value is None else _number(value * unit, unit),
                str(len(limit.scan.crossings)),
                _number(limit.scan.end * unit, unit),
            )
        )
    found = ["", *table(limits), *_k_tot(result)] if result.limits else []
    return [*head, *result.left_out, "", *table(modes), *found]


def _number(value: float, unit: float) -> str:
    return f"{value:.6g} {'ms' if unit > 1.0 else 'x'}"


def _k_tot(result: Stability) -> list[str]:
    found: Any = result.as_dict()["k_tot"]
    words = {side: "none found" if value is None else f"{value} N/m" for side, value in found.items()}
    return ["", f"k_tot: lower limit {words['lower']}, upper limit {words['upper']}"]
