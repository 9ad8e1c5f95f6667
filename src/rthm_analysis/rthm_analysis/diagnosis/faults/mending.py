"""Everything that is wrong with a recording, found and mended in an order in which each step can trust
the last.
"""

from __future__ import annotations

from dataclasses import dataclass

from rthm_analysis.diagnosis.faults.belonging import find_wrong_spec
from rthm_analysis.diagnosis.faults.delays import find_delays
from rthm_analysis.diagnosis.faults.drift import find_drift
from rthm_analysis.diagnosis.faults.dropouts import find_dropouts
from rthm_analysis.diagnosis.faults.factors import find_factors
from rthm_analysis.diagnosis.faults.hum import find_hum
from rthm_analysis.diagnosis.faults.known_loads import find_loads
from rthm_analysis.diagnosis.faults.spikes import find_spikes
from rthm_analysis.diagnosis.faults.stuck import find_stuck
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.spec import Spec


@dataclass(frozen=True)
class Mended:
    """A recording as it should have been.

    Attributes
    ----------
    evidence : Evidence
        Corrected; damaged stretches are NaN in `measured`.
    faults : tuple of Fault
        What was wrong.
    notes : tuple of str
        What else is odd about it, one sentence each.
    """

    evidence: Evidence
    faults: tuple[Fault, ...] = ()
    notes: tuple[str, ...] = ()


def mend(evidence: Evidence, spec: Spec) -> Mended:
    """Find what is wrong with a recording, rather than with the rig, and correct it where that is sure.

    Parameters
    ----------
    evidence : Evidence
        Of a hybrid test, or of a plant under known forces.
    spec : Spec
        The nominal model; stated uncertainties are allowed for.

    Returns
    -------
    Mended
        The same evidence and no faults where nothing is wrong beyond doubt.

    Examples
    --------
    >>> mended = mend(gather(recording, spec), spec)  # doctest: +SKIP
    >>> [fault.kind for fault in mended.faults]  # doctest: +SKIP
    ['sign']
    """
    faults: list[Fault] = []
    for find in (find_dropouts, find_stuck, find_spikes):
        evidence, found = find(evidence)
        faults += found
    for find_with in (find_factors, find_loads, find_drift, find_delays, find_hum, find_wrong_spec):
        evidence, found = find_with(evidence, spec)
        faults += found
    return Mended(evidence, tuple(faults))
