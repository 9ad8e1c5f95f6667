"""`import rthm`: quick, every example in it runs, every docstring is whole, every error is one sentence."""

from __future__ import annotations

import doctest
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rthm

ROOT = Path(__file__).parents[3]
FUNCTIONS = ("component", "diagnose", "energy", "import_table", "load", "read", "response", "sensitivities",
             "simulate", "simulate_many", "stability", "sweep", "timing")  # fmt: skip
SECTIONS = ("Parameters", "Returns", "Raises", "Examples")
CPU = "import numpy, time; before = time.process_time(); import rthm; print(time.process_time() - before)"


def failed(text: str, name: str) -> int:
    """Examples of a text that print something else than it says."""
    test = doctest.DocTestParser().get_doctest(text, {}, name, name, 0)
    assert test.examples
    return doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_example_of_every_function_prints_what_it_says(
    name: str, rig: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(rig)
    assert failed(inspect.getdoc(getattr(rthm, name)) or "", name) == 0


def test_the_examples_of_the_module_and_of_the_readme_print_what_they_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```pycon\n(.*?)^```$", readme, re.DOTALL | re.MULTILINE)
    assert blocks
    assert failed(rthm.__doc__ or "", "rthm") == 0
    assert failed("\n".join(blocks), "README") == 0


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_docstring_of_every_function_tells_every_parameter_returns_raises_and_an_example(
    name: str,
) -> None:
    text = inspect.getdoc(getattr(rthm, name)) or ""
    heads = [f"{head}\n{'-' * len(head)}\n" for head in SECTIONS]
    places = [text.find(head) for head in heads]
    assert min(places) > 0 and places == sorted(places)
    for parameter in inspect.signature(getattr(rthm, name)).parameters:
        assert re.search(rf"^{parameter} : ", text[places[0] : places[1]], re.MULTILINE), parameter


def test_everything_that_is_named_is_there_and_nothing_else() -> None:
    for name in rthm.__all__:
        assert getattr(rthm, name) is not None
    assert set(FUNCTIONS) | {"Effect", "InputError", "__version__"} == set(rthm.__all__)
    with pytest.raises(AttributeError, match="no 'simulat', only"):
        rthm.simulat  # noqa: B018


def test_the_import_takes_less_than_50_ms_beyond_that_of_numpy() -> None:
    done = (
        subprocess.run([sys.executable, "-c", CPU], check=True, capture_output=True, text=True)
        for _ in range(3)
    )
    assert min(float(one.stdout) for one in done) < 0.05


def test_a_misspelt_spec_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(rthm.InputError, match="paper is one"):
        rthm.simulate("papr", 1.0)


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan")])
def test_a_duration_that_is_no_time_is_refused_with_its_value(duration: float) -> None:
    with pytest.raises(rthm.InputError, match=rf"duration {duration!r} is not allowed"):
        rthm.simulate("paper", duration)
