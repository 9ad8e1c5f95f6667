from __future__ import annotations

from pathlib import Path

from rthm_core.effects import BLOCKS, effect, kinds
from rthm_core.spec import parameters, shipped_names, shipped_spec
from rthm_core.spec.reference import reference

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "spec.md"


def test_the_reference_page_is_what_the_schema_says() -> None:
    assert PAGE.read_text(encoding="utf-8") == reference(), (
        "run: python -m rthm_core.spec.reference docs/reference/spec.md"
    )


def test_the_reference_page_has_every_entry_and_every_kind() -> None:
    page = reference()
    for name in shipped_names():
        for one in parameters(shipped_spec(name)):
            assert f"`{one.name.rpartition('.')[2]}`" in page
    for block in BLOCKS:
        for kind in kinds(block):
            assert effect(kind, block).equation.replace("|", "\\|") in page
