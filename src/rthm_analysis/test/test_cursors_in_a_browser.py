"""The two cursors of plots over time, in Chromium: by mouse, finger and keyboard, and on paper."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from bokeh.models import Range1d
from browser import Tab, browser

from rthm_analysis.report.colours import COLOURS
from rthm_analysis.report.figures import Curves, steps
from rthm_analysis.report.page import Section, assemble, write_page

LONG = "/data/2026/november/shaking_table/second_series/late.mcap"
READY = "document.readyState == 'complete' && document.documentElement.dataset.ready"
TOGGLE = "[...document.querySelectorAll('.bar button')].find(one => one.textContent === 'cursors').click()"
PLOTS = "[...Bokeh.index.roots].filter(one => one.model.toolbar)"
SPANS = PLOTS + "[{}].model.center.filter(one => one.type === 'Span')"
TIMES = f"{SPANS.format(0)}.map(one => one.location)"
SHOWN = "document.querySelectorAll('.cursors')[{}]"
CELLS = f"[...{SHOWN}.querySelectorAll('tr')].map(row => [...row.cells].map(cell => cell.textContent))"
SHEET = """[...document.querySelector('.on-paper').shadowRoot.querySelectorAll('text')]
    .map(one => one.textContent)"""
MIDDLE = """(() => { const one = %s; one.scrollIntoView({block: 'center'});
    const { left, top, width, height } = one.getBoundingClientRect();
    return [left, top, width, height]; })()"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two plots over the same axis of time, one over another axis."""
    t, one, other = np.linspace(0.0, 10.0, 401), Range1d(0.0, 10.0), Range1d(0.0, 5.0)
    position, force, late = (
        Curves("a", "position (m)", one), Curves("b", "force (N)", one), Curves("c", "age (s)", other),
    )  # fmt: skip
    position.add("line", t, 2.0 * t, COLOURS[0])
    position.add(LONG, t, np.where(t < 5.0, np.nan, np.sin(t)), COLOURS[1])
    force.add("held", *steps(np.arange(11.0), np.arange(11.0) ** 2), COLOURS[2])
    late.add("other", t / 2.0, t, COLOURS[3])
    path = tmp_path_factory.mktemp("cursors") / "page.html"
    parts = [[one.finish()] for one in (position, force, late)]
    write_page(assemble("cursors", "", [Section("Curves", "", parts)], "", ""), path)
    return path


@pytest.fixture(scope="module")
def tab() -> Iterator[Tab]:
    with browser() as tab:
        yield tab


def opened(tab: Tab, page: Path, width: int = 1300, *, phone: bool = False, cursors: bool = True) -> None:
    tab.resize(width, phone=phone)
    tab.forget()
    tab.open(page.as_uri())
    tab.wait_for(READY)
    if cursors:
        tab.value(TOGGLE)
        tab.value("new Promise(done => setTimeout(done, 100))")


def slider(tab: Tab, number: int) -> list[float]:
    """Left, top, width and height of a slider of the first plot, in the middle of the window."""
    return tab.value(MIDDLE % f"document.querySelectorAll('.cursors input')[{number}]")


def test_cursors_are_hidden_until_asked_for_and_then_stand_in_all_plots_over_their_axis(
    tab: Tab, page: Path
) -> None:
    opened(tab, page, cursors=False)
    visible = "[0, 1, 2].map(k => document.querySelectorAll('.cursors')[k].checkVisibility())"
    lines = f"[0, 1, 2].map(k => ({SPANS.replace('{}', 'k')}).every(one => one.visible))"
    assert tab.value(visible) == [False] * 3 == tab.value(lines)
    tab.value(TOGGLE)
    assert tab.value(visible) == [True, True, False] == tab.value(lines)
    assert tab.value(TIMES) == pytest.approx([10.0 / 3.0, 20.0 / 3.0])
    tab.value(TOGGLE)
    assert tab.value(visible) == [False] * 3
    assert tab.complaints == []


def test_the_text_tells_times_their_difference_its_inverse_and_every_curve_with_units(
    tab: Tab, page: Path
) -> None:
    opened(tab, page)
    tab.value(f"({SPANS.format(0)}).forEach((one, k) => {{ one.location = [2.5, 6.5][k]; }})")
    words = "t1 = 2.5000 s, t2 = 6.5000 s, t2 − t1 = 4.0000 s, 1/(t2 − t1) = 0.25 Hz"
    for k in range(2):
        assert tab.value(f"{SHOWN.format(k)}.querySelector('p').textContent").replace("\xa0", " ") == words
    head, line, late = tab.value(CELLS.format(0))
    assert head == ["", "at t1 (m)", "at t2 (m)", "difference (m)"]
    assert line == ["line", "5", "13", "8"]
    assert late == [LONG, "–", f"{math.sin(6.5):.4g}", "–"]
    assert tab.value(CELLS.format(1))[1:] == [["held", "4", "36", "32"]]


def test_a_curve_that_is_hidden_is_not_told(tab: Tab, page: Path) -> None:
    opened(tab, page)
    tab.value(
        f"[...document.querySelectorAll('.bar button')].find(one => one.textContent === '{LONG}').click()"
    )
    assert [row[0] for row in tab.value(CELLS.format(0))] == ["", "line"]


def test_arrow_keys_move_a_cursor_by_a_small_step_and_with_shift_by_ten_and_never_out_of_view(
    tab: Tab, page: Path
) -> None:
    opened(tab, page)
    tab.value("document.querySelector('.cursors input').focus()")
    tab.press("ArrowRight")
    assert tab.value(TIMES) == pytest.approx([10.0 / 3.0 + 0.02, 20.0 / 3.0])
    tab.press("ArrowLeft", shift=True)
    assert tab.value(TIMES)[0] == pytest.approx(10.0 / 3.0 - 0.18)
    for _ in range(20):
        tab.press("ArrowLeft", shift=True)
    assert tab.value(TIMES)[0] == 0.0


def test_a_line_is_drawn_along_by_mouse_and_the_axis_stays(tab: Tab, page: Path) -> None:
    opened(tab, page)
    x, y, width, _ = slider(tab, 0)
    per_second = (width - 16.0) / 10.0
    tab.drag(x + 8.0 + per_second * 10.0 / 3.0, y - 120.0, 2.0 * per_second)
    assert tab.value(TIMES) == pytest.approx([10.0 / 3.0 + 2.0, 20.0 / 3.0], abs=0.05)
    assert tab.value(f"{PLOTS}[0].model.x_range.end") == 10.0


@pytest.mark.parametrize("finger", [False, True])
def test_a_slider_moves_its_line_by_mouse_and_on_a_phone_by_finger(
    tab: Tab, page: Path, finger: bool
) -> None:
    opened(tab, page, 390 if finger else 1300, phone=finger)
    x, y, width, height = slider(tab, 1)
    per_second = (width - 16.0) / 10.0
    tab.drag(x + 8.0 + per_second * 20.0 / 3.0, y + 0.5 * height, -3.0 * per_second, finger=finger)
    assert tab.value(TIMES) == pytest.approx([10.0 / 3.0, 20.0 / 3.0 - 3.0], abs=0.1)
    assert tab.value("document.documentElement.scrollWidth <= window.innerWidth")


def test_cursors_that_are_out_of_view_come_into_it_when_shown_again(tab: Tab, page: Path) -> None:
    opened(tab, page)
    tab.value(TOGGLE)
    tab.value(f"{PLOTS}[0].model.x_range.setv({{start: 0.5, end: 2}})")
    tab.value(TOGGLE)
    assert tab.value(TIMES) == pytest.approx([1.0, 1.5])


@pytest.mark.parametrize("cursors", [False, True])
def test_paper_has_cursors_only_where_they_were_set(tab: Tab, page: Path, cursors: bool) -> None:
    opened(tab, page, cursors=cursors)
    tab.value(f"addEventListener('beforeprint', () => {{ window.sheet = {SHEET}; }})")
    assert tab.printed().startswith(b"%PDF")
    assert ({"t1", "t2"} <= set(tab.value("window.sheet"))) is cursors
    tab.call("Emulation.setEmulatedMedia", media="print")
    assert tab.value(f"{SHOWN.format(0)}.querySelector('input')?.checkVisibility()") is False
    assert tab.value(f"{SHOWN.format(0)}.checkVisibility()") is cursors
    tab.call("Emulation.setEmulatedMedia", media="")


def test_the_line_under_the_mouse_is_the_same_in_plots_over_one_axis(tab: Tab, page: Path) -> None:
    opened(tab, page, cursors=False)
    x, y, width, height = tab.value(MIDDLE % "document.querySelector('.live')")
    tab.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + 0.5 * width, y=y + 0.5 * height)
    overlays = (
        f"{PLOTS}.map(one => "
        "one.model.toolbar.tools.find(tool => tool.type === 'CrosshairTool').overlay.location)"
    )
    tab.wait_for(f"{overlays}[0] > 0")
    first, second, third = tab.value(overlays)
    assert first == second != third


def test_a_long_name_leaves_room_for_its_numbers_on_a_phone(tab: Tab, page: Path) -> None:
    opened(tab, page, 390, phone=True)
    right = "[...document.querySelectorAll('.cursors td')].map(one => one.getBoundingClientRect().right)"
    assert max(tab.value(right)) <= tab.value(
        "document.querySelector('figure').getBoundingClientRect().right"
    )
