"""Layouts for other programs name what a test publishes."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

from rthm_core.spec import shipped_spec
from rthm_core.topics import BESIDE, JOINT_STATE, LOOP

LAYOUTS = Path(__file__).parents[1] / "docs" / "how-to" / "layouts"
LOOPED = shipped_spec("paper").loop()
NAMES = {
    "plant/state": (*LOOPED.plant.dofs, *LOOPED.actuator.names),
    "numerical/state": LOOPED.numerical.dofs,
    "numerical/force_reference": LOOPED.actuator.names,
    "actuator/command": LOOPED.actuator.names,
}


def energies() -> tuple[str, ...]:
    """Names on ``energy``, as its node lists them; the node itself needs ROS."""
    source = Path(__file__).parents[1] / "src/rthm_analysis/rthm_analysis/node.py"
    terms = re.search(r"^TERMS = \((.*?)\)", source.read_text(), re.DOTALL | re.MULTILINE)
    assert terms is not None
    return tuple(re.findall(r'"(\w+)"', terms[1]))


def curves_of_plotjuggler() -> list[tuple[str, str, str]]:
    """Topic, name and field of every curve; PlotJuggler joins them so."""
    curves = [one.get("name", "") for one in ElementTree.parse(LAYOUTS / "plotjuggler.xml").iter("curve")]
    return [re.fullmatch(r"/rthm/(.+)/(\w+)/(\w+)", curve).groups() for curve in curves]


def curves_of_foxglove() -> list[tuple[str, str, str]]:
    """The same of Foxglove, which counts the places of an array."""
    panels = json.loads((LAYOUTS / "foxglove.json").read_text())["configById"].values()
    found = []
    for path in (path["value"] for panel in panels for path in panel["paths"]):
        topic, field, place = re.fullmatch(r"/rthm/([\w/]+)\.(\w+)\[(\d)\]", path).groups()
        found.append((topic, (NAMES | {"energy": energies()})[topic][int(place)], field))
    return found


def test_both_layouts_show_the_same_curves_and_all_of_them_exist() -> None:
    curves = curves_of_plotjuggler()
    assert curves == curves_of_foxglove()
    assert len(curves) == 14
    for topic, name, field in curves:
        assert (LOOP | BESIDE)[topic] == JOINT_STATE
        assert name in (NAMES | {"energy": energies()})[topic]
        assert (
            field in ("effort",)
            if topic in ("energy", "numerical/force_reference")
            else ("position", "effort")
        )


def test_every_curve_of_foxglove_has_a_legend_and_every_panel_a_unit() -> None:
    panels = json.loads((LAYOUTS / "foxglove.json").read_text())["configById"].values()
    assert [re.search(r"\[(\w)\]$", panel["title"])[1] for panel in panels] == ["m", "N", "J"]
    assert all(panel["showLegend"] and all(path["label"] for path in panel["paths"]) for panel in panels)
