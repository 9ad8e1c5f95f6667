"""The page of both parts, from the numbers that each has written."""

from __future__ import annotations

import json
from pathlib import Path

from benchmarks.concealed import table as first
from benchmarks.concealed.open import table as second

SECOND = "_open"  # what the name of the second part's files ends with


def write_page(out: Path) -> Path:
    """Write the page beside the numbers of a part, given by their path without ending, and return its path.

    A part that was not made yet is left out.
    """
    stem = out.with_name(out.name.removesuffix(SECOND))
    parts = ((stem, first.markdown), (stem.with_name(stem.name + SECOND), second.markdown))
    made = [(path.with_suffix(".json"), words) for path, words in parts]
    texts = [words(json.loads(path.read_text())) for path, words in made if path.exists()]
    page = stem.with_suffix(".md")
    page.write_text("# Diagnosis on concealed cases\n\n" + "\n".join(texts))
    return page
