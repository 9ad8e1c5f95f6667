"""A domain id that no other run on this host uses, and a namespace in it that no other run leads."""

from __future__ import annotations

import hashlib
import os
import random
import re
import socket
from pathlib import Path

from rthm_core.errors import InputError

LAST_PRIVATE = 101  # above, the ports of a domain meet those that Linux gives to clients


class Claim:
    """A domain id, claimed until `release` or the end of this process.

    Parameters
    ----------
    wanted
        A domain id to use, claimed by nobody; None chooses a free one.

    Attributes
    ----------
    domain : int
    """

    def __init__(self, wanted: int | None = None) -> None:
        self._lock: socket.socket | None = None
        self.domain = self._free() if wanted is None else wanted

    def release(self) -> None:
        """Let others use the domain."""
        if self._lock is not None:
            self._lock.close()

    def _free(self) -> int:
        for domain in random.sample(range(1, LAST_PRIVATE + 1), LAST_PRIVATE):
            claim = _claimed(domain)
            if claim is not None and _silent(domain):
                self._lock = claim
                return domain
            if claim is not None:
                claim.close()
        raise InputError("Every domain from 1 to 101 is in use on this host; name one with --domain.")


class Leadership:
    """Right to lead the test in a namespace of a domain on this host, until `release` or the process ends.

    Raises
    ------
    InputError
        If another run has it.
    """

    def __init__(self, domain: int, namespace: str) -> None:
        lock = _held(_name_of(str(domain), namespace))
        if lock is None:
            raise InputError(
                f"Another run on this host leads the test in domain {domain}, namespace {namespace}; wait for"
                " its end, or choose another --namespace or --domain."
            )
        self._lock = lock

    def release(self) -> None:
        """Let another run lead."""
        self._lock.close()


def led(namespace: str) -> list[int]:
    """Domains in which a run on this host leads a test in a namespace.

    Examples
    --------
    >>> with_a_run = Leadership(7, "/an_example")
    >>> led("/an_example")
    [7]
    >>> with_a_run.release()
    """
    pattern = re.compile(re.escape("@") + _name_of(r"(\d+)", namespace) + "$", re.MULTILINE)
    return sorted({int(domain) for domain in pattern.findall(Path("/proc/net/unix").read_text())})


def wanted(option: int | None, fixed: bool) -> int | None:
    """Domain that is asked for: the option, else ROS_DOMAIN_ID, else 0 if others must find it, else any."""
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if option is not None:
        return option
    if not text:
        return 0 if fixed else None
    if not text.isascii() or not text.isdigit():
        raise InputError(
            f"ROS_DOMAIN_ID is {text!r}, but must be a number from 0 to 232; correct or unset it."
        )
    return int(text)


def _name_of(domain: str, namespace: str) -> str:
    """Name that the leader of a test holds."""
    return f"rthm-run-{domain}-{hashlib.sha256(namespace.encode()).hexdigest()[:16]}"


def _claimed(domain: int) -> socket.socket | None:
    """Hold the domain among the runs of this host."""
    return _held(f"rthm-domain-{domain}")


def _held(name: str) -> socket.socket | None:
    """Hold a name on this host; the kernel gives it back when the process ends. None: somebody else does."""
    claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claim.bind(f"\0{name}")
    except OSError:
        claim.close()
        return None
    return claim


def _silent(domain: int) -> bool:
    """Whether no ROS node listens in the domain: its first unicast ports can be bound."""
    for participant in range(3):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", 7410 + 250 * domain + 2 * participant))
            except OSError:
                return False
    return True
