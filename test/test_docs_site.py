"""The documentation as a site: every page is in it, every link leads somewhere, every example runs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rthm

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples" / "gallery").glob("[0-9]*.py"))


def site(folder: Path, *options: str) -> Path:
    """The site, made from a copy of what it is made of; any warning is an error."""
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=shutil.ignore_patterns("gallery"))
    shutil.copytree(ROOT / "examples" / "gallery", folder / "examples" / "gallery")
    words = ["-q", "-b", "html", "--fail-on-warning", "--keep-going", *options, "docs", "site"]
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", *words],
        cwd=folder,
        env=os.environ | {"MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "site"


def test_the_site_has_every_page_and_every_function_and_asks_nobody_else_for_anything(tmp_path: Path) -> None:
    made = site(tmp_path, "-D", "plot_gallery=0")
    pages = {page.relative_to(ROOT / "docs").with_suffix(".html") for page in (ROOT / "docs").rglob("*.md")}
    assert not [page for page in pages if not (made / page).is_file()]
    reference = (made / "reference" / "api.html").read_text(encoding="utf-8")
    assert not [
        name for name in rthm.__all__ if name != "__version__" and f'id="rthm.{name}"' not in reference
    ]
    loaded = re.compile(r'(?:src|rel="stylesheet"[^>]*href)="(https?:[^"]*)"')
    assert not [found for page in made.rglob("*.html") for found in loaded.findall(page.read_text("utf-8"))]
    for page, heading in linked_by_pages():
        assert f'id="{heading}"' in (made / f"{page}.html").read_text(encoding="utf-8"), (page, heading)


def linked_by_pages() -> set[tuple[str, str]]:
    """Pages and headings to which reports and diagnoses link."""
    sources = (ROOT / "src" / "rthm_analysis" / "rthm_analysis" / "report").glob("*.py")
    named = re.compile(r'"((?:how-to/|reference/)?[a-z-]+)#([a-z-]+)"')
    return {found for source in sources for found in named.findall(source.read_text(encoding="utf-8"))}


@pytest.mark.long
def test_every_example_of_the_gallery_runs_and_shows_a_picture(tmp_path: Path) -> None:
    made = site(tmp_path)
    assert len(EXAMPLES) >= 5
    for example in EXAMPLES:
        page = (made / "gallery" / f"{example.stem}.html").read_text(encoding="utf-8")
        assert f"sphx_glr_{example.stem}_001.png" in page, example.stem
