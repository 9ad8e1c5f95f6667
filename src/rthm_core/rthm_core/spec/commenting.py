"""Write a spec as a file to go on from: with unit and meaning of every entry, and a word on every section."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping

from rthm_core.spec.catalogue import sections
from rthm_core.spec.parameters import Parameter, parameters
from rthm_core.spec.schema import Spec
from rthm_core.spec.writing import HEAD, Line, lines

COLUMN, WIDTH = 44, 110
"""Where comments begin behind entries, and where every line ends."""

TALKATIVE = ("load.plant", "load.numerical", "uncertainty.plant", "uncertainty.actuator")
"""Sections within a section that has said enough."""


def commented_spec(spec: Spec, head: str = "", notes: Mapping[str, str] | None = None) -> str:
    r"""Return the spec as YAML text with comments; `read_spec` of it gives the same spec.

    Parameters
    ----------
    spec : Spec
    head : str
        What the file begins with; paragraphs stand on lines of their own.
    notes : mapping of str, optional
        What there is to say of a section or an entry, by dotted name, beside what the schema says of it.

    Examples
    --------
    >>> from rthm_core.spec import shipped_spec
    >>> text = commented_spec(shipped_spec("decay"), "A decay.", {"plant.mass": "Weighed."})
    >>> print(*text.splitlines()[:8], sep="\n")
    # A decay.
    /**:
      ros__parameters:
        # Substructure with n degrees of freedom, M a = -C v - K x + forces; matrices row-major, n*n.
        plant:
          dofs: ["x1"]                          # names of the degrees of freedom, one for each
          # Weighed.
          mass: [1.2]                           # kg; mass matrix M, symmetric and positive definite
    """
    entries = {one.name: one for one in parameters(spec)}
    about = {key: _first(of.__doc__) for key, of in sections() if key and key not in TALKATIVE}
    said = [line for paragraph in head.splitlines() for line in _comment(paragraph, "")]
    body = (text for line in lines(spec) for text in _told(line, entries, about, notes or {}))
    return "\n".join([*said, *HEAD, *body]) + "\n"


def _told(
    line: Line, entries: Mapping[str, Parameter], about: Mapping[str, str], notes: Mapping[str, str]
) -> Iterator[str]:
    """A line of the file with what there is to say of it."""
    indent = line.text[: len(line.text) - len(line.text.lstrip())]
    for words in (about.get(line.name, "") if line.is_section else "", notes.get(line.name, "")):
        yield from _comment(words, indent)
    if line.is_section:
        yield line.text
        return
    beside = _words(entries[line.name])
    whole = f"{line.text.ljust(COLUMN - 2)}  # {beside}"
    if len(whole) <= WIDTH:
        yield whole
    else:
        yield from _comment(beside, indent)
        yield line.text


def _words(entry: Parameter) -> str:
    """Unit and meaning of an entry."""
    return f"{entry.unit}; {entry.description}" if entry.unit not in ("", "1") else entry.description


def _comment(words: str, indent: str) -> list[str]:
    return [f"{indent}# {line}" for line in textwrap.wrap(words, WIDTH - len(indent) - 2)]


def _first(docstring: str | None) -> str:
    """First paragraph of a docstring."""
    return " ".join((docstring or "").split("\n\n")[0].split()).replace("``", "")
