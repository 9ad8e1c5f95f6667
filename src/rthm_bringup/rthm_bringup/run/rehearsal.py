"""Get ready, while the nodes do, for what comes after the test: nothing is loaded or compiled for it then."""

from __future__ import annotations

import threading
from contextlib import suppress

from rthm_core.errors import InputError
from rthm_core.spec import Spec


class Rehearsal:
    """Imports and compiles in the background what the analysis of a test takes.

    Parameters
    ----------
    spec
        The test.
    """

    def __init__(self, spec: Spec) -> None:
        self._thread = threading.Thread(target=_rehearse, args=(spec,), name="rehearsal", daemon=True)
        self._thread.start()

    @property
    def over(self) -> bool:
        """Whether it is done."""
        return not self._thread.is_alive()


def _rehearse(spec: Spec) -> None:
    """Move the ideal system of the page for two samples; what is wrong with it, the page itself tells."""
    import rthm_analysis.report.figures
    import rthm_analysis.timing  # noqa: F401
    from rthm_core.engine import simulate

    with suppress(InputError):
        period = spec.loop().timing.td1
        simulate(spec, 2.0 * period, period, "ideal", energies=False)
