"""Pages in Chromium: on a desk, on a phone, in the dark, on paper and by keyboard."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, browser

from rthm_analysis.comparison import compare, motions_at
from rthm_analysis.diagnosis.missing.binned import spread_over
from rthm_analysis.recording import read_recording
from rthm_analysis.report import write_report
from rthm_analysis.report.colours import palette
from rthm_analysis.report.comparison import write_comparison
from rthm_analysis.report.diagnosis import write_diagnosis
from rthm_analysis.report.runs import write_runs
from rthm_analysis.reproduce import reproduce
from rthm_analysis.runs import Run, runs_in
from rthm_core.spec import shipped_spec

from .conftest import mcap_file
from .loop import recorded
from .test_diagnosis_page import SAID

WITH_PLOTS = ("report", "diagnosis", "compare")
NAMES = (*WITH_PLOTS, "reproduce", "runs")
A4 = int((210 - 2 * 14) / 25.4 * 96)
"""Width of what is printed, px."""

READY = "document.readyState == 'complete' && (!window.Bokeh || document.documentElement.dataset.ready)"
FOCUSED = "document.activeElement.outerHTML.slice(0, 300)"
REACHABLE = """[...document.querySelectorAll('main a, main button, main summary')]
    .filter(one => one.checkVisibility()).map(one => one.outerHTML.slice(0, 300))"""
CUT = """[...document.querySelectorAll('.on-paper')].filter(one => {
    const frame = one.getBoundingClientRect(), cut = (part) => {
        const { left, right } = part.getBoundingClientRect();
        return left < frame.left - 1 || right > frame.right + 1;
    };
    return [...one.shadowRoot.querySelectorAll('path, text, circle, line')].some(part =>
        !part.closest('defs, clipPath, [clip-path]') && cut(part));
}).length"""


OTHERS = ("zoom ", "move ", "drag: ", "show all", "cursors")
FILES = (" as SVG", " as CSV")


class Plot:
    """One plot of a page, by its number from the top."""

    def __init__(self, tab: Tab, number: int) -> None:
        self.tab = tab
        self.figure = f"document.querySelectorAll('figure.plot')[{number}]"
        self.model = f"[...Bokeh.index.roots].find(one => {self.figure}.contains(one.el)).model"
        self.buttons = f"[...{self.figure}.querySelectorAll('.bar button')]"

    def value(self, expression: str) -> Any:
        return self.tab.value(f"{self.model}.{expression}")

    def labels(self) -> list[str]:
        return self.tab.value(f"{self.buttons}.map(one => one.ariaLabel || one.textContent)")

    def press(self, label: str) -> tuple[float, float]:
        """Press a button; return what is seen then."""
        self.tab.value(f"{self.buttons}[{self.labels().index(label)}].click()")
        return self.seen()

    def seen(self) -> tuple[float, float]:
        return self.value("x_range.start"), self.value("x_range.end")

    def active(self) -> list[bool]:
        """Whether a drag zooms, and whether it moves."""
        tool = "toolbar.tools.find(one => one.type === '{}').active"
        return [self.value(tool.format(one)) for one in ("BoxZoomTool", "PanTool")]

    def shown(self, curve: str) -> set[bool]:
        return set(self.value(f"renderers.filter(one => one.name === {curve!r}).map(one => one.visible)"))


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder, spec = tmp_path_factory.mktemp("pages"), shipped_spec("paper")
    bag = mcap_file(folder / "loop.mcap", recorded(spec, 3.0))
    made = {name: folder / f"{name}.html" for name in WITH_PLOTS}
    write_report(bag, made["report"])
    v = np.linspace(-1.0, 1.0, 999)
    law = replace(SAID.curves[0], law=spread_over(v, -0.05 * np.sign(v)))
    write_diagnosis(replace(SAID, curves=(law,)), read_recording(bag), spec, made["diagnosis"])
    made["match"] = folder / "match.html"
    match = replace(SAID, curves=(law,), verdict="match")
    write_diagnosis(match, read_recording(bag), spec, made["match"])
    write_comparison(compare(motions_at([str(bag), "paper"]), only=["x1", "a1.force"]), made["compare"])
    write_runs(runs_of(folder / "out", bag), folder / "out", folder / "runs.html")
    return made | {"reproduce": reproduce(folder / "paper", ["figure02"]).page, "runs": folder / "runs.html"}


def runs_of(out: Path, bag: Path) -> list[Run]:
    """A run with a report, and one that left nothing."""
    for name in ("whole", "dead"):
        (out / name / "bag").mkdir(parents=True)
    write_report(bag, out / "whole" / "report.html")
    return runs_in(out)


@pytest.fixture(scope="module")
def tab() -> Iterator[Tab]:
    with browser() as tab:
        yield tab


def opened(tab: Tab, page: Path, width: int = 1300, *, dark: bool = False, phone: bool = False) -> None:
    """Load a page anew, and wait until its plots are drawn."""
    tab.resize(width, dark=dark, phone=phone)
    tab.forget()
    tab.open(page.resolve().as_uri())
    tab.wait_for(READY)


@pytest.mark.parametrize("name", NAMES)
def test_a_page_complains_of_nothing_asks_nobody_and_fits_a_phone(
    tab: Tab, pages: dict[str, Path], name: str
) -> None:
    opened(tab, pages[name], 390, phone=True)
    assert tab.complaints == []
    assert [one for one in tab.requests if not one.startswith(("file:", "data:", "blob:"))] == []
    assert tab.value("document.documentElement.scrollWidth") == 390


@pytest.mark.parametrize("name", WITH_PLOTS)
def test_a_finger_that_swipes_over_a_plot_scrolls_the_page(
    tab: Tab, pages: dict[str, Path], name: str
) -> None:
    opened(tab, pages[name], 390, phone=True)
    top = tab.value("(document.querySelector('.live').scrollIntoView({block: 'center'}), window.scrollY)")
    tab.swipe()
    assert tab.value("window.scrollY") > top + 200


@pytest.mark.parametrize("name", WITH_PLOTS)
@pytest.mark.parametrize("width", [1600, 390])
def test_every_figure_is_whole_on_paper_however_wide_the_window_was(
    tab: Tab, pages: dict[str, Path], name: str, width: int
) -> None:
    opened(tab, pages[name], width)
    tab.value(f"addEventListener('beforeprint', () => {{ window.cut = {CUT}; }})")
    tab.value(
        "addEventListener('beforeprint', () => { window.sheets = "
        "[...document.querySelectorAll('.on-paper')].map(one => one.getBoundingClientRect().width); })"
    )
    assert tab.printed().startswith(b"%PDF")
    sheets = tab.value("window.sheets")
    assert len(sheets) == tab.value("document.querySelectorAll('figure.plot').length") > 0
    assert tab.value("window.cut") == 0
    assert max(sheets) < 182 / 25.4 * 96 + 1
    assert tab.value("document.querySelectorAll('.on-paper').length") == 0


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_wider_than_paper(tab: Tab, pages: dict[str, Path], name: str) -> None:
    opened(tab, pages[name], A4)
    tab.call("Emulation.setEmulatedMedia", media="print")
    lost = tab.value(
        f"""[...document.querySelectorAll('main *')].filter(one => !one.closest('.live'))
        .filter(one => one.getBoundingClientRect().right > {A4 + 1})
        .map(one => one.outerHTML.slice(0, 100))"""
    )
    tab.call("Emulation.setEmulatedMedia", media="")
    assert lost == []


def test_a_heading_stays_with_what_follows_it_on_paper(tab: Tab, pages: dict[str, Path]) -> None:
    opened(tab, pages["diagnosis"])
    tab.call("Emulation.setEmulatedMedia", media="print")
    style = (
        "(({ display, breakAfter }) => [display, breakAfter])(getComputedStyle(document.querySelector('h2')))"
    )
    assert tab.value(style) == ["block", "avoid"]  # a break can be avoided after blocks alone
    tab.call("Emulation.setEmulatedMedia", media="")


@pytest.mark.parametrize("name", NAMES)
def test_the_keyboard_reaches_every_control(tab: Tab, pages: dict[str, Path], name: str) -> None:
    opened(tab, pages[name])
    tab.value("document.querySelectorAll('details').forEach(one => { one.open = true; })")
    wanted = tab.value(REACHABLE)
    tab.value(f"window.reached = [], addEventListener('focusin', () => window.reached.push({FOCUSED}))")
    plots = tab.value("document.querySelectorAll('.live').length")
    for _ in range(len(wanted) + plots + 20):
        tab.press("Tab")
    assert set(wanted) <= set(tab.value("window.reached"))


@pytest.mark.parametrize("name", WITH_PLOTS)
def test_every_button_does_what_it_says(tab: Tab, pages: dict[str, Path], name: str) -> None:
    opened(tab, pages[name])
    for number in range(tab.value("document.querySelectorAll('figure.plot').length")):
        plot = Plot(tab, number)
        begin, end = plot.seen()
        quarter, near = 0.25 * (end - begin), pytest.approx
        assert plot.press("zoom in") == near((begin + quarter, end - quarter))
        assert plot.press("move right") == near((begin + 1.5 * quarter, end - 0.5 * quarter))
        assert plot.press("move left") == near((begin + quarter, end - quarter))
        assert plot.press("zoom out") == near((begin, end))
        plot.press("zoom in")
        assert plot.press("show all") == near((begin, end))
        for label, tools in (("move", [False, True]), ("zoom", [True, False]), ("zoom", [False, False])):
            plot.press(f"drag: {label}")
            assert plot.active() == tools
        curves = [one for one in plot.labels() if not one.startswith(OTHERS) and not one.endswith(FILES)]
        assert set(curves) == {one for one in plot.value("renderers.map(one => one.name)") if one}
        for curve in curves:
            for shown in (False, True):
                plot.press(curve)
                assert plot.shown(curve) == {shown}


def test_what_a_match_leaves_is_folded_and_drawn_once_it_is_asked_for(
    tab: Tab, pages: dict[str, Path]
) -> None:
    opened(tab, pages["match"])
    figure = "document.querySelector('#the-missing-force figure.plot')"
    assert tab.value(f"{figure}.checkVisibility()") is False
    tab.value("document.querySelector('#the-missing-force summary').click()")
    tab.wait_for(f"{figure}.querySelector('.live').getBoundingClientRect().width > 600")
    assert tab.complaints == []


def test_a_view_that_is_moved_to_an_end_keeps_its_length(tab: Tab, pages: dict[str, Path]) -> None:
    opened(tab, pages["report"])
    plot = Plot(tab, 0)
    begin, end = plot.press("zoom in")
    for _ in range(5):
        last = plot.press("move right")
    assert last == pytest.approx((2 * begin, 2 * begin + end - begin))


def test_a_figure_leaves_the_page_as_svg_and_csv(tab: Tab, pages: dict[str, Path], tmp_path: Path) -> None:
    opened(tab, pages["report"], dark=True)
    tab.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    for kind in ("SVG", "CSV"):
        tab.value(
            f"[...document.querySelectorAll('.bar button')].find(one => one.textContent === '{kind}').click()"
        )
        tab.value("new Promise(done => setTimeout(done, 300))")
    svg, csv = (
        tmp_path / f"hybrid-test-loop-mcap-position-beside-the-ideal-system.{kind}" for kind in ("svg", "csv")
    )
    drawn = svg.read_text()
    assert "x1 plant" in drawn and palette()["--curve-1"] in drawn and "<image" not in drawn
    head, first, *_ = csv.read_text().splitlines()
    assert '"x1 plant: position (m)"' in head.split(",")
    assert float(first.split(",")[head.split(",").index('"x1 plant: position (m)"')]) == 0.5


@pytest.mark.parametrize("name", WITH_PLOTS)
def test_plots_take_the_colours_of_the_dark(tab: Tab, pages: dict[str, Path], name: str) -> None:
    opened(tab, pages[name], dark=True)
    paper = tab.value("getComputedStyle(document.documentElement).getPropertyValue('--paper').trim()")
    assert paper != palette()["--paper"]
    fills = (
        "[...Bokeh.index.roots].filter(one => one.model.toolbar).map(one => one.model.background_fill_color)"
    )
    shown = {one["value"] if isinstance(one, dict) else one for one in tab.value(fills)}
    assert shown == {paper}


@pytest.mark.parametrize("name", WITH_PLOTS)
def test_every_plot_has_words_for_who_does_not_see_it_and_units(pages: dict[str, Path], name: str) -> None:
    told = re.findall(r'role="img" aria-label="([^"]+)"', pages[name].read_text(encoding="utf-8"))
    plots = [one for one in told if "Over " in one]
    assert len(plots) >= 2
    assert all(re.search(r"\((m|m/s|N|J|ms|s|%)\)", one) for one in plots)


def test_no_two_colours_of_the_palette_are_the_same_so_that_each_has_its_own_in_the_dark() -> None:
    assert len(set(palette().values())) == len(palette()) > 20
