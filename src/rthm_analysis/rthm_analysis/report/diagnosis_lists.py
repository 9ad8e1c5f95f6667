"""What a diagnosis says beside its named physics: faults, described forces, traces, refusals, free runs."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from rthm_analysis.diagnosis.result import Diagnosis
from rthm_analysis.report.tables import with_symbols


def faults(diagnosis: Diagnosis) -> str:
    """One line per fault of the recording or of the spec."""
    return _list(one.words for one in diagnosis.faults)


def described(diagnosis: Diagnosis) -> str:
    """One line per force that the data show and no kind fits."""
    return _list(one.words for one in diagnosis.described)


def traces(diagnosis: Diagnosis) -> str:
    """One line per effect that is there and does not matter, folded."""
    return _folded("negligible effects", [one.words for one in diagnosis.traces])


def refused(diagnosis: Diagnosis) -> str:
    """One line per hypothesis that was tried and not taken, folded."""
    return _folded("rejected hypotheses", [one.words for one in diagnosis.refused])


def next_test(diagnosis: Diagnosis) -> list[str]:
    """What to do next, and its spec, folded, where it is a test of the rig."""
    said = [f"<div>{escape(diagnosis.next_experiment)}</div>"]
    if diagnosis.next_experiment_spec:
        spec = escape(diagnosis.next_experiment_spec.strip())
        said.append(f"<details><summary>Show its spec</summary><pre>{spec}</pre></details>")
    return said


def _list(lines: Iterable[str]) -> str:
    items = "".join(f"<li>{escape(with_symbols(one))}</li>" for one in lines)
    return f"<ul>{items}</ul>" if items else ""


def _folded(what: str, lines: list[str]) -> str:
    return f"<details><summary>{len(lines)} {what}</summary>{_list(lines)}</details>" if lines else ""
