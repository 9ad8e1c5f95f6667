"""A dashboard from its start to its end: finds a test, shows it and its report, and finds the next one."""

from __future__ import annotations

import os
import threading
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from rthm_bringup.dashboard.cost import Cost, step_back
from rthm_bringup.dashboard.hub import Hub
from rthm_bringup.dashboard.report import Report
from rthm_bringup.dashboard.server import Server
from rthm_bringup.interruption import Interruption, held_back
from rthm_bringup.run.domain import led
from rthm_bringup.run.environment import BUILTIN, PROFILES, Network
from rthm_core.errors import InputError
from rthm_core.ros.reach import HOST

if TYPE_CHECKING:
    from rthm_analysis.dashboard import RunningTest
    from rthm_bringup.dashboard.watcher_node import Watcher

SNAPSHOT_PERIOD = 0.1
"""Between two snapshots, s."""
SEARCH = 0.5
"""Between two looks for a run on this host, s."""
LOOPBACK = Path(__file__).with_name("loopback.xml")


class Dashboard:
    """Shows the tests of a host or a network, one after the other.

    Parameters
    ----------
    network
        Where to look.
    find
        Whether the domain is that of the run that is found on this host, whatever `network` says.
    port
        Of the page.

    Attributes
    ----------
    hub, server
        What is shown, and who serves it.
    """

    def __init__(self, network: Network, find: bool, port: int) -> None:
        self._network, self._find = network, find
        self.hub = Hub()
        self.server = Server(self.hub, port)
        self.server.report = lambda: self._report.file if self._report else None
        self._cost = Cost()
        self._test: RunningTest | None = None
        self._report: Report | None = None
        self._unread = ""
        self._interruption = Interruption()

    def run(self) -> None:
        """Go on until somebody interrupts."""
        step_back()
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        with TemporaryDirectory() as log, closing(self.server), held_back() as self._interruption:
            os.environ.update(variables(self._network) | {"ROS_LOG_DIR": log})
            try:
                while True:
                    self._show(self._found())
            except KeyboardInterrupt:
                return

    def _found(self) -> Network:
        """Network of the next test; what there was before is shown until there is one."""
        if not self._find:
            return self._network
        while not (domains := led(self._network.namespace)):
            self._look()
            time.sleep(SEARCH)
        return replace(self._network, domain=_only(domains))

    def _show(self, network: Network) -> None:
        """Show a test to its end, and look for its report as long as its run goes on."""
        from rthm_bringup.dashboard.watcher_node import Watcher  # ROS reads its environment when imported

        began = time.time()
        with closing(Watcher(network)) as watcher:
            while not watcher.over and (not self._find or self._is_led(network)):
                self._listen(watcher)
            self.hub.abort = None
            if watcher.test is None:
                return
            watcher.test.end()
            self._report = Report(watcher.bag, began)
        while not self._report.over or (self._find and self._is_led(network)):
            self._look()
            time.sleep(SEARCH)

    def _listen(self, watcher: Watcher) -> None:
        """Take what has come by the next multiple of the period, and show it."""
        time.sleep(SNAPSHOT_PERIOD - time.monotonic() % SNAPSHOT_PERIOD)
        with self.hub.changing:
            watcher.take()
            self._unread = watcher.unread
            if watcher.test not in (None, self._test):
                self._test, self._report = watcher.test, None
            self.hub.abort = watcher.abort if watcher.test and watcher.can_abort else None
            self._look()

    def _look(self) -> None:
        self._interruption.obey()
        beside: dict[str, Any] = {"cost": self._cost.share(), "report": None}
        if self._unread:
            beside["words"] = self._unread
        if self._report is not None:
            beside["report"] = {"words": self._report.words, "ready": self._report.file is not None}
        self.hub.look(self._test, beside)

    def _is_led(self, network: Network) -> bool:
        """Whether a run of this host is on in that domain; of one elsewhere only its nodes tell."""
        return network.domain in led(network.namespace)


def variables(network: Network) -> dict[str, str]:
    """Environment of a listener that shares no memory with the test.

    Shared memory has locks that a publisher needs too: a process of the lowest priority that holds one while
    others compute would hold up the loop.
    """
    told = network.variables() | {BUILTIN: "UDPv4"}
    return told | ({PROFILES: str(LOOPBACK)} if network.reach == HOST else {})


def _only(domains: list[int]) -> int:
    if len(domains) > 1:
        raise InputError(
            f"Tests run in the domains {', '.join(map(str, domains))}; choose one with --domain."
        )
    return domains[0]
