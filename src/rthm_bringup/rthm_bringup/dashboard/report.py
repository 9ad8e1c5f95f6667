"""The report of a test that is over, where it is on this host."""

from __future__ import annotations

import time
from pathlib import Path

REPORT_WITHIN = 120.0
"""How long the analysis of a recording may take, s."""
WRITTEN_AFTER = 0.5
"""How long a file must not have changed before it counts as written, s."""


class Report:
    """Looks for the report of a run beside its bag.

    Parameters
    ----------
    bag : str
        Folder of the recording as its recorder knows it; empty: not known.
    since : float
        A file that is older, s since 1970, is the report of another run.
    """

    def __init__(self, bag: str, since: float) -> None:
        self._file = Path(bag).with_name("report.html") if bag else None
        self._since, self._patient_until = since, time.monotonic() + REPORT_WITHIN

    @property
    def file(self) -> Path | None:
        """The report; None: it is not there, or is being written."""
        try:
            changed = self._file.stat().st_mtime if self._file else 0.0
        except OSError:
            return None
        return self._file if self._since <= changed < time.time() - WRITTEN_AFTER else None

    @property
    def over(self) -> bool:
        """Whether there is nothing to wait for any more."""
        return self._file is None or self.file is not None or time.monotonic() > self._patient_until

    @property
    def words(self) -> str:
        """A sentence on it."""
        if self.file is not None:
            return f"Its report is {self.file}."
        if not self.over:
            return "Its recording is being analysed."
        where = f"There is no {self._file} on this host" if self._file else "Its recorder did not answer"
        return f"{where}: the report is on the host where rthm run was started."
