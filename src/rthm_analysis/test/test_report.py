"""The page about a recorded test."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bokeh.models import CrosshairTool, Line, Range1d, Scatter

from rthm_analysis.bag_analysis import analyse_bag, to_json, write_beside
from rthm_analysis.report import documentation, verdict, write_report
from rthm_analysis.report.colours import COLOURS
from rthm_analysis.report.figures import Curves, is_sparse, only_rounding, periods
from rthm_analysis.report.gathered import gather
from rthm_analysis.report.thinning import extremes
from rthm_core.errors import InputError
from rthm_core.spec import shipped_spec

from .conftest import START, joint_state, mcap_file, plant_samples, text
from .loop import recorded

SPEC = shipped_spec("paper")
ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def loop_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mcap_file(tmp_path_factory.mktemp("loop") / "loop.mcap", recorded(SPEC, 3.0))


@pytest.fixture(scope="module")
def loop_page(loop_bag: Path) -> str:
    page = loop_bag.with_suffix(".html")
    write_report(loop_bag, page)
    return page.read_text(encoding="utf-8")


def embedded(page: str, name: str) -> dict[str, object]:
    found = re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found.group(1))


def test_the_numbers_in_the_page_are_those_of_the_command_line(loop_bag: Path, loop_page: str) -> None:
    energy, timing = analyse_bag(loop_bag)
    assert embedded(loop_page, "energy") == json.loads(to_json(energy.as_dict()))
    assert embedded(loop_page, "timing") == json.loads(to_json(timing.as_dict()))


def test_the_page_needs_nothing_from_elsewhere(loop_page: str) -> None:
    assert not re.search(r"<(script|link|img|iframe)[^>]*(src|href)=", loop_page)
    assert "@import" not in loop_page


def test_the_page_shows_the_loop_with_its_delays_and_all_parts(loop_page: str) -> None:
    for delay in ("τ1 = 4 ms", "τ2 = 8 ms", "τ3 = 12 ms", "τ4 = 10 ms", "at use 8.4 ms"):
        assert delay in loop_page
    for part in ("The loop", "Motion", "Force", "Energy", "Delays", "Clocks", "Spec"):
        assert f"<h2>{part}</h2>" in loop_page
    for words in ("Position cancellation drained", "Force feedforward introduced", "Equivalent damping"):
        assert words in loop_page
    for words in (
        "x1 ideal",
        "reference for a1",
        "The balance closes to rounding.",
        "Age at use, tau3",
    ):
        assert words in loop_page


def test_periods_are_drawn_where_ticks_were_not_on_time(loop_bag: Path, loop_page: str) -> None:
    assert "Period of Td" not in loop_page
    found = gather(loop_bag)
    late = replace(found.timing.clocks["td2"], period=np.array([0.012, 0.0121, np.nan]))
    timing = replace(found.timing, clocks=found.timing.clocks | {"td2": late})
    assert [plot.title.text for plot in periods(replace(found, timing=timing))] == ["Period of Td2"]


def test_a_plant_alone_has_a_page_without_a_loop(tmp_path: Path) -> None:
    spec = (
        "/**:\n  ros__parameters:\n    plant: {dofs: [x1], mass: [1.0], damping: [0.0], stiffness: [1.0], "
        "initial_position: [1.0], initial_velocity: [0.0]}\n"
    )
    bag = mcap_file(tmp_path / "plant.mcap", [text("/rthm/spec", spec), *plant_samples()])
    write_report(bag, tmp_path / "page" / "plant.html")
    page = (tmp_path / "page" / "plant.html").read_text(encoding="utf-8")
    assert "<h2>Motion</h2>" in page
    assert "<h2>The loop</h2>" not in page
    assert embedded(page, "energy")["E_fx"][0] is None


def test_what_is_nothing_but_rounding_is_not_drawn() -> None:
    assert only_rounding(np.array([3e-14, np.nan]), np.array([2.25]))
    assert only_rounding(np.zeros(2), np.zeros(2))
    assert not only_rounding(np.array([3e-6]), np.array([2.25]))


def test_a_recording_without_a_spec_has_a_page_that_says_so(tmp_path: Path) -> None:
    bag = mcap_file(tmp_path / "bare.mcap", plant_samples())
    write_report(bag, tmp_path / "bare.html")
    page = (tmp_path / "bare.html").read_text(encoding="utf-8")
    assert "no topic /rthm/spec" in page
    assert "<h2>Motion</h2>" in page


def test_names_from_a_recording_cannot_become_part_of_the_page(tmp_path: Path) -> None:
    name = "</script><script>alert(1)</script>"
    states = [joint_state("/plant/state", START + k * 1_000_000, (name,), (float(k),)) for k in range(9)]
    write_report(mcap_file(tmp_path / "odd.mcap", states), tmp_path / "odd.html")
    assert "<script>alert(1)" not in (tmp_path / "odd.html").read_text(encoding="utf-8")


def test_a_page_that_cannot_be_written_is_refused_in_a_sentence(loop_bag: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write_report(loop_bag, tmp_path / "file" / "page.html")


def test_thinning_keeps_the_peak_of_a_long_curve() -> None:
    values = np.sin(np.linspace(0.0, 50.0, 100_000))
    values[54_321] = 7.0
    rows = extremes(values, spans=200)
    assert rows.size <= 402
    assert 54_321 in rows
    assert rows[0] == 0
    assert rows[-1] == values.size - 1


def test_energies_are_written_beside_the_bag(loop_bag: Path) -> None:
    energy, _ = analyse_bag(loop_bag)
    place = write_beside(loop_bag, energy)
    assert place == loop_bag.with_name("loop.mcap.energy.json")
    assert json.loads(place.read_text()) == json.loads(to_json(energy.as_dict()))


def test_the_verdict_has_four_lines_of_result_and_the_state_of_the_links(loop_bag: Path) -> None:
    facts = verdict(*analyse_bag(loop_bag))
    assert [fact.label for fact in facts] == [
        "Position cancellation drained",
        "Force feedforward introduced",
        "Numerical side introduced",
        "Equivalent damping",
        "Missed deadlines",
        "Lost or late samples",
    ]
    assert facts[4].value == "none"


def test_a_motion_of_three_samples_per_swing_is_drawn_as_dots_and_a_fine_one_as_a_line() -> None:
    coarse, fine = np.arange(0.0, 60.0, 0.2), np.arange(0.0, 60.0, 0.01)
    assert is_sparse(np.sin(2.0 * np.pi * coarse / 0.6 + 0.1))
    assert not is_sparse(np.sin(2.0 * np.pi * fine / 0.6))
    assert not is_sparse(np.full(100, np.nan))
    curves = Curves("motion", "position (m)", Range1d(0.0, 60.0))
    curves.add("x1", coarse, np.sin(2.0 * np.pi * coarse / 0.6 + 0.1), COLOURS[0])
    assert [type(one.glyph) for one in curves.finish().renderers] == [Line, Scatter]


def test_plots_over_one_axis_of_time_share_their_cursor() -> None:
    span = Range1d(0.0, 1.0)
    plots = [Curves(name, "m", span).plot for name in "ab"]
    one, other = (tool.overlay for plot in plots for tool in plot.tools if isinstance(tool, CrosshairTool))
    assert one is other


LINKED = re.compile(r'"((?:how-to/|reference/)?[a-z-]+)#([a-z-]+)"')
"""Part of the documentation, as a section names it."""


def test_every_part_of_the_documentation_that_a_section_names_exists() -> None:
    sources = (ROOT / "src" / "rthm_analysis" / "rthm_analysis" / "report").glob("*.py")
    named = {found for source in sources for found in LINKED.findall(source.read_text(encoding="utf-8"))}
    assert len(named) >= 12
    for page, heading in named:
        text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
        headings = re.findall(r"^#+ ([A-Za-z ]+)$", text, re.MULTILINE)
        assert heading in {one.lower().replace(" ", "-") for one in headings}, (page, heading)


def test_every_heading_links_to_the_site_that_the_environment_names(
    loop_bag: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RTHM_DOCS", "https://docs.example/rthm/")
    write_report(loop_bag, tmp_path / "linked.html")
    page = (tmp_path / "linked.html").read_text(encoding="utf-8")
    links = re.findall(r'</h2><a class="about" href="https://docs.example/rthm/([^"]+)"', page)
    assert len(links) == page.count("<section ") and "how-to/read-a-report.html#motion" in links
    monkeypatch.setenv("RTHM_DOCS", "")
    write_report(loop_bag, tmp_path / "bare.html")
    assert 'class="about"' not in (tmp_path / "bare.html").read_text(encoding="utf-8")


def test_without_a_name_the_documentation_is_the_site_of_the_checkout_or_the_pages_it_is_made_from(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RTHM_DOCS", raising=False)
    monkeypatch.setattr(documentation, "CHECKOUT", tmp_path)
    assert documentation.address("time#at-one-instant") == ""
    for folder, name in (("docs", "time.md"), ("out/docs", "time.html")):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / name).touch()
        expected = f"{(tmp_path / folder / name).as_uri()}#at-one-instant"
        assert documentation.address("time#at-one-instant") == expected
