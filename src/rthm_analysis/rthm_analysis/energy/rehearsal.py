"""Compile the energy balance before a test begins, so that nothing is compiled while it runs."""

from __future__ import annotations

import numpy as np

from rthm_analysis.energy.ledger import EnergyLedger
from rthm_core.spec import Spec


def rehearse(spec: Spec) -> None:
    """Compute the energy balance of a loop that rests for a few samples."""
    loop = spec.loop()
    period = loop.timing.ns("td1")
    ledger = EnergyLedger(spec, 0, period * 1e-9)
    stamps = np.arange(8, dtype=np.int64) * period
    n1, n2, m = len(loop.plant.dofs), len(loop.numerical.dofs), len(spec.k_tot)

    def rest(width: int) -> np.ndarray:
        return np.zeros((stamps.size, width))

    ledger.add_plant(stamps, rest(n1), rest(n1), rest(n1))
    ledger.add_numerical(stamps, rest(n2), rest(n2))
    ledger.add_commands(stamps, rest(m), rest(m))
    for link in ("tau2", "tau4"):
        ledger.add_uses(link, stamps, stamps)
    ledger.advance()
