"""Tables of the page of a diagnosis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from rthm_analysis.diagnosis.numbers import bare, number, percent, with_unit
from rthm_analysis.diagnosis.result import Diagnosis, Physics
from rthm_analysis.report.tables import table

MODEL_WORDS = {
    "nominal": "as specified",
    "retuned": "retuned",
    "explained": "explained",
    "noise_floor": "noise",
}
"""Keys of `Fit.nrmse`, in words."""


def mismatches(diagnosis: Diagnosis) -> str:
    """One row per block: its prediction error over noise."""
    rows = [
        [one.block, f"!{one.mismatch:.4g}" if one.significant else f"{one.mismatch:.4g}"]
        for one in diagnosis.blocks
    ]
    return _folded(f"All {len(rows)} blocks", table(("block", "error over noise"), rows)) if rows else ""


def physics(diagnosis: Diagnosis) -> str:
    """One row per parameter of what was found."""
    head = ("what", "where", "parameter", "value", "squared error removed")
    rows = [row for one in diagnosis.physics for row in _physics(one)]
    return table(head, rows) if rows else ""


def _physics(one: Physics) -> list[list[str]]:
    rows = []
    for i, (name, value) in enumerate(one.parameters.items()):
        where = f"{one.block} {one.place}" if one.place else one.block
        head = [one.kind.replace("_", " "), where] if i == 0 else ["", ""]
        told = value if isinstance(value, str) else _shown(number(value.value, value.std, value.unit))
        share = percent(one.share) if i == 0 and math.isfinite(one.share) else ""
        rows.append([*head, name.replace("_", " "), told, share])
    return rows


def retuned(diagnosis: Diagnosis) -> str:
    """One row per parameter that has another value than assumed."""
    head = ("retuned", "as specified", "in this recording", "change")
    rows = []
    for name, one in diagnosis.retuned.items():
        unit = one.unit
        new = _shown(number(one.value, one.std, unit))
        rows.append([name, with_unit(one.nominal, unit, 4), new, _change(one.nominal, one.value)])
    return table(head, rows) if rows else ""


def _shown(text: str) -> str:
    return text.replace("+-", "\N{PLUS-MINUS SIGN}")


def _change(nominal: float, value: float) -> str:
    return f"{100.0 * (value / nominal - 1.0):+.1f} %" if nominal else ""


def fits(diagnosis: Diagnosis) -> str:
    """One row per located block: errors on unseen data."""
    models = models_told([one.nrmse for one in diagnosis.fits])
    head = ("signal", "held-out part", "free runs of", *(MODEL_WORDS[name] for name in models))
    rows = [
        [
            f"{one.signal} ({one.block})",
            f"{one.held_out[0]:.4g} to {one.held_out[1]:.4g} s",
            "all of it" if one.window is None else f"{one.window:.3g} s",
            *(_percent(one.nrmse.get(name)) for name in models),
        ]
        for one in diagnosis.fits
    ]
    words = '<p class="unit">Errors over the signal\'s standard deviation there.</p>'
    return table(head, rows) + words if rows else ""


def free_runs(diagnosis: Diagnosis) -> str:
    """One row per dof: errors of one free run over the unseen part."""
    errors = {
        dof: {"nominal": run.nominal, "retuned": run.retuned, "explained": run.explained}
        for dof, run in diagnosis.free_run.items()
    }
    models = [name for name in models_told(list(errors.values())) if name != "noise_floor"]
    rows = [
        [dof, f"{bare(diagnosis.free_run[dof].seconds)} s", *(percent(told[name], 3) for name in models)]
        for dof, told in errors.items()
    ]
    return table(("free run of", "over", *(MODEL_WORDS[name] for name in models)), rows) if rows else ""


def recordings(diagnosis: Diagnosis) -> str:
    """One row per signal of each recording, where several were diagnosed together."""
    models = models_told([errors for one in diagnosis.recordings for errors in one.nrmse.values()])
    head = ("recording", "", "signal", *(MODEL_WORDS[name] for name in models))
    rows = [
        [
            one.name,
            "held out" if one.held_out else "fitted",
            signal,
            *(_percent(errors.get(name)) for name in models),
        ]
        for one in diagnosis.recordings
        for signal, errors in one.nrmse.items()
    ]
    words = '<p class="unit">Errors over the signal\'s standard deviation in that recording.</p>'
    return table(head, rows) + words if rows else ""


def models_told(errors: Sequence[Mapping[str, float]]) -> list[str]:
    """Models whose errors are shown: those that are not all the same as the specified one's."""
    told = ("nominal", "noise_floor")
    return [
        name for name in MODEL_WORDS if name in told or any(e.get(name) != e.get("nominal") for e in errors)
    ]


def _percent(part: float | None) -> str:
    return "–" if part is None or not math.isfinite(part) else percent(part, 3)


def alternatives(diagnosis: Diagnosis) -> str:
    """One row per kind that was tried beside what was named."""
    head = ("what", "where", "held-out error of its signal", "this recording")
    rows = [
        [
            one.kind.replace("_", " "),
            one.block,
            _percent(one.held_out_nrmse),
            "rules it out" if one.distinguishable else "!cannot distinguish it",
        ]
        for one in diagnosis.alternatives
    ]
    return table(head, rows) if rows else ""


def limits(diagnosis: Diagnosis) -> str:
    """One row per parameter of an effect that would have been seen, folded."""
    rows = [
        [*_effect(name), with_unit(one.value, one.unit, 2)]
        for name, one in sorted(diagnosis.detection_limits.items())
    ]
    head = ("effect", "parameter", "smallest")
    return _folded(f"All {len(rows)} effects", table(head, rows)) if rows else ""


def _effect(name: str) -> Sequence[str]:
    """Effect and parameter of ``plant.coulomb_friction.force``."""
    effect, _, parameter = name.rpartition(".")
    return effect.replace("_", " "), parameter.replace("_", " ")


def _folded(summary: str, html: str) -> str:
    return f"<details><summary>{summary}</summary>{html}</details>"
