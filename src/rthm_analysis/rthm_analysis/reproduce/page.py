"""One page with every figure and table, self-contained."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from urllib.parse import quote

from rthm_analysis.report.embedding import Embedding
from rthm_analysis.report.provenance import provenance
from rthm_analysis.reproduce.curves import curves
from rthm_analysis.reproduce.errata import Erratum
from rthm_analysis.reproduce.files import table_file
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.tables import Table

TITLE = "The paper, reproduced"
INTRODUCTION = (
    "Figures and tables of “Effect of Time Delays and Sampling in Force Actuated Real-Time Hybrid Testing; "
    "A Case Study”, computed by this project's own code from the paper's text. "
    "<code>rthm reproduce</code> writes this page and the files beside it: every picture as PNG and SVG, "
    "every number as CSV, what was found as <code>numbers.json</code>."
)
CONDITIONAL = (
    "depends on M<sub>2</sub> and k<sub>3</sub>, which cannot be recovered from the paper: thin lines and "
    "bands show the other candidate sets"
)


def page(
    folder: Path,
    plates: Sequence[Plate],
    numbers: Mapping[str, Numbers],
    tables: Mapping[str, Table],
    errata: Sequence[Erratum],
) -> str:
    """Page as text; pictures are taken from `folder` and put into it."""
    style = (files("rthm_analysis.report") / "page.css").read_text(encoding="utf-8")
    own = (files(__package__) / "page.css").read_text(encoding="utf-8")
    embedding = Embedding()
    body = "".join(_plate(folder, plate, numbers[plate.name], embedding) for plate in plates)
    shown = f"<div class='tables'>{''.join(_table(table) for table in tables.values())}</div>"
    return (
        "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'>"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>"
        f"<title>{TITLE}</title><style>{style}{own}</style></head>\n<body><main>"
        f"<header><h1>{TITLE}</h1><p>{INTRODUCTION}</p>{_contents(plates, tables)}</header>\n"
        f"{_dependence(plates)}{shown}{body}"
        f"{_errata(errata)}<footer>{provenance()}</footer></main>{embedding.scripts()}</body></html>\n"
    )


def _contents(plates: Sequence[Plate], tables: Mapping[str, Table]) -> str:
    parts: tuple[Table | Plate, ...] = (*tables.values(), *plates)
    titles = {one.name: one.title for one in parts} | {"errata": "Errata"}
    links = "".join(f"<a href='#{name}'>{escape(title)}</a>" for name, title in titles.items())
    return f"<nav class='contents' aria-label='Contents'>{links}</nav>"


def _dependence(plates: Sequence[Plate]) -> str:
    free = " and ".join(escape(one.title.partition(":")[0]) for one in plates if not one.conditional)
    return (
        "<section><h2>What stands on what</h2><p>M<sub>2</sub> and k<sub>3</sub> are lost with Table II. "
        f"{free} and Tables I and II do not depend on them; every other figure, and Table III, does. They "
        "are drawn for M<sub>2</sub> = 1.5 kg, k<sub>3</sub> = 6 N/m, and the spread over five sets that fit "
        "all that the text says is shown in each.</p></section>"
    )


def _plate(folder: Path, plate: Plate, numbers: Numbers, embedding: Embedding) -> str:
    data = base64.b64encode((folder / f"{plate.name}.svg").read_bytes()).decode("ascii")
    depends = f"<p class='depends'>This figure {CONDITIONAL}.</p>" if plate.conditional else ""
    wide = " wide" if plate.name == "figure13" else ""
    return (
        f"<section class='plate{wide}' id='{plate.name}'><figure>"
        f"<img src='data:image/svg+xml;base64,{data}' alt='{escape(plate.title, quote=True)}'></figure>"
        f"<div><h2>{escape(plate.title)}</h2><p><b>The paper:</b> {escape(plate.paper)}</p>"
        f"<p><b>Found:</b> {escape(plate.found(numbers))}</p>{depends}"
        f"{_values(numbers)}{_files(plate, numbers)}</div>{_curves(numbers, embedding)}</section>\n"
    )


def _files(plate: Plate, numbers: Numbers) -> str:
    """Links to the files of a figure, which lie beside the page."""
    names = [f"{plate.name}.png", f"{plate.name}.svg"]
    names += [table_file(plate.name, table) for table in numbers.tables]
    links = ", ".join(f"<a href='{escape(quote(name))}'>{escape(name)}</a>" for name in names)
    return f"<p class='files'>{links}</p>"


def _curves(numbers: Numbers, embedding: Embedding) -> str:
    rows = "".join(embedding.row([plot]) for plot in curves(numbers))
    return f"<details class='zoom'><summary>Curves to zoom into</summary>{rows}</details>" if rows else ""


def _values(numbers: Numbers) -> str:
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{_number(value)}</td></tr>" for name, value in numbers.values.items()
    )
    return f"<details><summary>Numbers</summary><table>{rows}</table></details>"


def _table(table: Table) -> str:
    head = "".join(f"<th>{escape(one)}</th>" for one in table.head)
    rows = "".join("<tr>" + "".join(f"<td>{_cell(one)}</td>" for one in row) + "</tr>" for row in table.rows)
    return (
        f"<section class='table' id='{table.name}'><h2>{escape(table.title)}</h2><p>{escape(table.note)}</p>"
        f"<div class='scroll'><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"
        "</section>\n"
    )


def _cell(value: str | float) -> str:
    return escape(value) if isinstance(value, str) else _number(value)


def _number(value: float | None) -> str:
    """Four digits, or a power of ten."""
    if value is None:
        return "no value"
    if value == 0.0 or 1e-3 <= abs(value) < 1e5:
        return f"{value:.4g}"
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{mantissa}·10<sup>{int(exponent)}</sup>"


def _errata(errata: Sequence[Erratum]) -> str:
    names = ("equation", "printed", "corrected", "check", "off, printed", "off, corrected")
    head = "".join(f"<th>{name}</th>" for name in names)
    rows = "".join(
        f"<tr><td>{escape(one.equation)}</td><td>{escape(one.printed)}</td><td>{escape(one.corrected)}</td>"
        f"<td>{escape(one.check)}</td><td>{_number(one.error_printed)}</td>"
        f"<td>{_number(one.error_corrected)}</td></tr>"
        for one in errata
    )
    return (
        "<section class='errata' id='errata'><h2>Errata, each with its check</h2>"
        "<p>The last two columns say how far each form is off in the check; the project computes with the "
        "corrected ones.</p><div class='scroll'>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div></section>"
    )
