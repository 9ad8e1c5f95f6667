"""Tables of a page: links and clocks."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import Any

from rthm_analysis.timing import TimingResult

PLUS_MINUS = "\N{PLUS-MINUS SIGN}"

LATE_MS = 0.3
"""Excess at p99, in ms, above which a link is marked."""


def links(timing: TimingResult) -> str:
    """One row per link: age at use, excess over the exact schedule, lost and late samples."""
    head = ("link", "uses", "age mean", "p50", "p99", "max", "excess mean", "p99", "max", "lost", "late")
    rows = []
    for name, link in timing.links.items():
        told: dict[str, Any] = link.as_dict()
        age, excess = told["age"], told["excess"]
        cells = [name, str(told["count"])]
        cells += [_ms(age[key]) for key in ("mean", "p50", "p99", "max")]
        cells += [_ms(excess["mean"]), _marked(excess["p99"]), _ms(excess["max"])]
        rows.append([*cells, _count(link.lost), _count(link.late)])
    return table(head, rows) + '<p class="unit">Ages and excess in ms.</p>'


def clocks(timing: TimingResult) -> str:
    """One row per clock: period as it was, and missed ticks."""
    head = ("clock", "ticks", "period mean (ms)", "period p99 (ms)", "missed")
    rows = []
    for name, clock in timing.clocks.items():
        told: dict[str, Any] = clock.as_dict()
        cells = [
            name.capitalize(),
            str(clock.period.size + 1),
            _ms(told["period_mean"]),
            _ms(told["period_p99"]),
        ]
        rows.append([*cells, _count(clock.missed)])
    return table(head, rows)


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """HTML table; a cell that begins with ``!`` is marked."""
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(_cell(cell) for cell in row)}</tr>" for row in rows)
    return f'<div class="wide"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def _cell(text: str) -> str:
    return f'<td class="bad">{escape(text[1:])}</td>' if text.startswith("!") else f"<td>{escape(text)}</td>"


def _ms(seconds: float | None) -> str:
    return "–" if seconds is None else f"{1e3 * seconds:.3f}"


def _marked(seconds: float | None) -> str:
    return f"!{_ms(seconds)}" if seconds is not None and 1e3 * seconds > LATE_MS else _ms(seconds)


def _count(number: int) -> str:
    return f"!{number}" if number else "0"


def with_symbols(text: str) -> str:
    """Text of a terminal as a page has it: ``0.1 +- 0.02`` with its sign."""
    return text.replace("+-", PLUS_MINUS)
