"""The page of the dashboard in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
from browser import Tab, browser
from simulated_graph import BESIDE, running, served

from rthm_analysis.dashboard import RunningTest
from rthm_bringup.dashboard.hub import Hub
from rthm_bringup.dashboard.server import Server
from rthm_core.events import Abort, write_abort
from rthm_core.spec import LimitsSpec, shipped_spec

LIMITED = shipped_spec("paper").model_copy(update={"limits": LimitsSpec(command=1.0, rate=5.0, force=4.0)})
A4 = int((210 - 2 * 14) / 25.4 * 96)
"""Width of what is printed, px."""
DRAWN = (
    "document.querySelectorAll('#energy path.curve[d]').length == 8 && !!document.querySelector('#limits tr')"
)
LOST = """[...document.querySelectorAll('main *')]
    .filter((one) => one.getBoundingClientRect().right > document.documentElement.clientWidth + 1)
    .filter((one) => !one.closest('.curves svg, svg.rig'))
    .map((one) => one.outerHTML.slice(0, 80))"""


@pytest.fixture(scope="module")
def tab() -> Iterator[Tab]:
    with browser() as tab:
        yield tab


@pytest.fixture
def aborts() -> list[str]:
    return []


@pytest.fixture
def hub(aborts: list[str]) -> Hub:
    hub = Hub()
    hub.abort = lambda: aborts.append("asked for")
    return hub


@pytest.fixture
def server(hub: Hub) -> Iterator[Server]:
    with served(hub) as server:
        yield server


@pytest.fixture
def test(hub: Hub) -> RunningTest:
    return running(LIMITED, hub, 4.0)


def opened(tab: Tab, server: Server, width: int = 1200, *, dark: bool = False) -> None:
    tab.forget()
    tab.resize(width, dark=dark)
    tab.open(server.address)
    tab.wait_for(DRAWN)


@pytest.mark.parametrize(("width", "dark"), [(1200, False), (390, False), (390, True)])
def test_the_page_fits_complains_of_nothing_and_asks_nobody_else(tab, server, test, width, dark) -> None:
    opened(tab, server, width, dark=dark)
    assert tab.value("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    assert tab.value(LOST) == []
    assert tab.complaints == tab.said == []
    hosts = {urlsplit(address).netloc for address in tab.requests} - {""}
    assert hosts == {f"127.0.0.1:{server.server_port}"}
    light = tab.value("getComputedStyle(document.body).backgroundColor.match(/\\d+/)[0] > 128")
    assert light is not dark


def test_the_page_is_whole_on_paper(tab, server, test, tmp_path) -> None:
    opened(tab, server, A4)
    tab.call("Emulation.setEmulatedMedia", media="print")
    assert tab.value("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    assert tab.value(LOST) == []
    assert tab.value("document.getElementById('abort').checkVisibility()") is False
    tab.call("Emulation.setEmulatedMedia", media="")
    assert tab.printed().startswith(b"%PDF")


def test_the_page_shows_what_the_test_has_come_to(tab, server, hub, test) -> None:
    opened(tab, server)
    shown = hub.shown
    text = tab.value("document.body.innerText")
    assert "The test is running." in text and "4.0 s" in text and "of 20 s" in text
    assert f"{100 * shown['errors'][0]['nrmse']:.3g} %" in text
    assert "5 % of a processor core" in text
    assert tab.value("document.querySelector('#links tr').innerText.includes('4 ms')")
    assert tab.value("document.querySelectorAll('#limits tr').length") == 3
    names = tab.value(
        "[...document.querySelectorAll('svg[role=img]')].map((one) => one.getAttribute('aria-label'))"
    )
    assert len(names) == 11 and all(names)
    assert next(name for name in names if name.startswith("Motion")).startswith(
        "Motion over the last 20 s; now x1"
    )


def test_the_button_is_reached_by_keyboard_and_aborts(tab, server, hub, test, aborts) -> None:
    opened(tab, server)
    tab.value("document.body.focus()")
    tab.press("Tab")
    assert tab.value("document.activeElement.id") == "abort"
    assert tab.value("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    assert aborts == []
    tab.press("Enter")
    tab.wait_for("document.getElementById('abort-words').textContent == 'Abort requested.'")
    assert aborts == ["asked for"]
    test.told.note_event(write_abort(Abort(4.0, "operator", None, None, "asked for by the service")))
    hub.look(test, BESIDE)
    tab.wait_for("document.getElementById('words').textContent.startsWith('Aborted at 4.000 s')")
    assert tab.value("document.getElementById('abort').disabled")
    assert "asked for by the service" in tab.value("document.getElementById('log').innerText")


def test_nothing_can_be_aborted_where_no_controller_is(tab, server, hub, test) -> None:
    opened(tab, server)
    hub.abort = None
    hub.look(test, BESIDE)
    tab.wait_for("document.getElementById('abort').disabled")


def test_the_page_becomes_the_report_and_who_comes_back_stays(tab, server, hub, test, tmp_path) -> None:
    file = tmp_path / "report.html"
    file.write_text("<title>The report</title>")
    server.report = lambda: file
    opened(tab, server)
    test.end()
    hub.abort = None
    over = BESIDE | {"report": {"words": "Its report is there.", "ready": True}}
    hub.look(test, over)
    tab.wait_for("document.title == 'The report'")
    tab.open(server.address)
    tab.wait_for("document.getElementById('report-link') && !document.getElementById('report-link').hidden")
    tab.value("new Promise((done) => setTimeout(done, 2000))")
    assert tab.value("document.title") == "Running test"


def test_a_dashboard_that_has_gone_is_told(tab, hub, test) -> None:
    with served(hub) as server:
        opened(tab, server)
    tab.wait_for(
        "document.getElementById('words').textContent.startsWith('No answer from the dashboard server')"
    )
    assert tab.value("document.getElementById('abort').disabled")
