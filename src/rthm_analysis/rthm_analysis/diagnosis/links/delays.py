"""Delays of the spec that are not those with which the test was run.

A bag holds the spec that its nodes were started with. Where that has another tau than the spec of the
diagnosis, and the uses of the link keep to the former, the spec is wrong and not the link.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.criteria.links import LINK_KIND_GAIN
from rthm_analysis.diagnosis.links.evidence import LinkEvidence, link_evidence
from rthm_analysis.diagnosis.links.fitting import counted, fitted, grain
from rthm_analysis.recording import Recording
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.schedule import Schedule
from rthm_core.spec import apply
from rthm_core.topics import LINKS

if TYPE_CHECKING:
    from rthm_core.compiled import Integers
    from rthm_core.spec import Spec

BESIDE: tuple[tuple[str, ...], ...] = ((), ("spread",), ("lost",), ("spread", "lost"))
"""What a link may do beside its delay."""


def other_delays(recording: Recording, spec: Spec, spans: Integers) -> dict[str, int]:
    """Delays of the test, in ns, of the links whose tau in the spec is another.

    Parameters
    ----------
    spec : Spec
        With the clocks of the test.
    spans : (k, 2) array
        When a host stalled, as from `host_stalls`.
    """
    known = recording.spec
    if known is None or not known.is_loop:
        return {}
    there, here = known.loop().timing, spec.loop().timing
    differ = {name: there.ns(name) for name in LINKS if there.ns(name) != here.ns(name)}
    return {name: tau for name, tau in differ.items() if _kept(recording, spec, name, tau, spans)}


def _kept(recording: Recording, spec: Spec, name: str, tau: int, spans: Integers) -> bool:
    """Whether a link keeps to another tau rather than to the spec's; what no use denies is believed."""
    try:
        other = apply(spec, {f"timing.{name}": tau / NS})
    except InputError:  # The spec's own effects take more off than that tau has.
        return False
    nominal, told = (link_evidence(recording, one, Schedule(one), name, spans) for one in (spec, other))
    if isinstance(nominal, str) or isinstance(told, str):
        return True
    width = grain(nominal)
    return _likelihood(told, width) > _likelihood(nominal, width) + LINK_KIND_GAIN


def _likelihood(evidence: LinkEvidence, width: int) -> float:
    """Log-likelihood of the uses of a link that has exactly its delay, but may jitter or lose."""
    data = counted(evidence, width=width)
    return max(data.total(fitted(data, kinds, late=True)) for kinds in BESIDE)
