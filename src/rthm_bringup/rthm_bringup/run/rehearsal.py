"""Get ready, while the nodes do, for what comes after the test: nothing is loaded or compiled for it then."""

from __future__ import annotations

import threading
from contextlib import suppress
from typing import TYPE_CHECKING

from rthm_core.errors import InputError
from rthm_core.spec import Spec

if TYPE_CHECKING:
    from rthm_bringup.run.prediction import Prediction


class Rehearsal:
    """Imports and compiles in the background what the analysis of a test takes, and predicts the test.

    Parameters
    ----------
    spec
        The test.
    predicted
        Length of the test, s, if it is to be predicted, as it is where a real machine moves; else None.

    Attributes
    ----------
    prediction
        What is predicted, once that is known.
    """

    def __init__(self, spec: Spec, predicted: float | None = None) -> None:
        self.prediction: Prediction | None = None
        self._spec, self._predicted, self._ready = spec, predicted, threading.Event()
        self._thread = threading.Thread(target=self._rehearse, name="rehearsal", daemon=True)
        self._thread.start()

    @property
    def over(self) -> bool:
        """Whether the analysis is ready."""
        return self._ready.is_set() or not self._thread.is_alive()

    @property
    def predicted(self) -> bool:
        """Whether all is predicted that has to be."""
        return not self._thread.is_alive()

    def _rehearse(self) -> None:
        _prepare(self._spec)
        self._ready.set()
        if self._predicted is not None:
            from rthm_bringup.run.prediction import predicted

            self.prediction = predicted(self._spec, self._predicted)


def _prepare(spec: Spec) -> None:
    """Move the ideal system of the page for two samples; what is wrong with it, the page itself tells."""
    import rthm_analysis.report.figures
    import rthm_analysis.timing  # noqa: F401
    from rthm_core.engine import simulate

    with suppress(InputError):
        period = spec.loop().timing.td1
        simulate(spec, 2.0 * period, period, "ideal", energies=False)
