"""The list of all faults, and how a test with each has to end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from signal import SIGKILL, SIGSTOP

from benchmarks.faults.ways import (
    Cable,
    Disk,
    Memory,
    Operator,
    Rival,
    SecondRun,
    Sent,
    Spoiled,
    Way,
)

STALE, FROZEN, BEAT = ("stale",), ("frozen",), ("heartbeat",)
LATE = ("stale", "age")


@dataclass(frozen=True)
class Fault:
    """A fault, and how a test with it has to end.

    Attributes
    ----------
    name
        A word for it.
    group
        Heading under which it is listed.
    what
        What happens, in words.
    way
        How it is made.
    limits
        Limits of which one ends the test; none: the test goes on to its end.
    status
        Exit status; None: nobody is left to give one.
    words
        A part of what is told.
    given
        Limits that the spec gives instead of the usual ones.
    short
        Exit status and words where it is shorter than the limits allow.
    unwritten
        Where nothing can be told of an abort: ``bag``, ``page``, ``json``.
    """

    name: str
    group: str
    what: str
    way: Way
    limits: tuple[str, ...] = ()
    status: int | None = 3
    words: str = ""
    given: Mapping[str, float] = field(default_factory=dict)
    short: tuple[int, str] = (0, "")
    unwritten: tuple[str, ...] = ()

    def expected(self, allowed: Mapping[str, float]) -> tuple[tuple[str, ...], int | None, str]:
        """Limits, status and words under these limits; a fault that is shorter than they allow is none."""
        kept = dict(allowed) | dict(self.given)
        watched = [kept[limit] for limit in self.limits if limit in kept]
        if watched and self.way.lasting < min(watched):
            return (), *self.short
        return self.limits, self.status, self.words


def _rig(name: str, what: str, limits: tuple[str, ...], words: str) -> Fault:
    return Fault(name, "The rig and its driver", what, Spoiled(name), limits, words=words)


def _silent(seconds: float) -> Fault:
    what, way = f"the driver sends nothing for {seconds:g} s", Spoiled("silent", seconds)
    words = "plant/state has had no fresh sample"
    short = (1, "samples are missing")
    return Fault(f"silent-{seconds:g}", "The rig and its driver", what, way, STALE, words=words, short=short)


def _cable(seconds: float) -> Fault:
    what = f"the cable between controller and driver is out for {seconds:g} s"
    words = "plant/state has had no fresh sample"
    given = {"stale": 0.08} if seconds < 0.5 else {}
    what += f" (stale {given['stale']:g} s)" if given else ""
    return Fault(f"cable-{seconds:g}", "The network", what, Cable(seconds), STALE, words=words, given=given)


def _part(
    name: str, way: Sent, limits: tuple[str, ...], status: int | None, words: str, *unwritten: str
) -> Fault:
    verb = "killed (SIGKILL)" if way.number == SIGKILL else "stopped (SIGSTOP)"
    lasting = f" for {way.lasting:g} s" if way.lasting < float("inf") else ""
    what = f"the {PARTS[way.part]} is {verb}{lasting}"
    return Fault(name, "Parts of the test", what, way, limits, status, words, unwritten=unwritten)


PARTS = {
    "plant": "simulated plant",
    "driver": "driver",
    "numerical": "numerical substructure",
    "controller": "controller",
    "recorder": "recorder",
    "analysis": "analysis",
    "leader": "leader",
}
"""What each part is called."""


def _memory(part: str, limits: tuple[str, ...], status: int, words: str) -> Fault:
    what = f"the {PARTS[part]} gets no more memory than it has"
    return Fault(f"memory-{part}", "The host", what, Memory(part), limits, status, words)


RIG = (
    _rig("nan", "the force sensor reads not a number", ("finite",), "force sensor of a1 reads not a number"),
    _rig("inf", "the position sensor reads infinity", ("finite",), "position sensor of x1 reads infinity"),
    _rig("huge", "the position sensor reads 1e9 m", ("step",), "the position sensor of x1 steps by 1e+09 m"),
    _rig("step", "the position sensor reads 0.3 m more", ("step",), "the position sensor of x1 steps by 0."),
    _rig("frozen", "the position sensor is frozen", FROZEN, "the position sensor of x1 has read"),
    _rig("cut", "the load cell is cut, and reads 0 N", FROZEN, "the force sensor of a1 has read 0 N"),
    _rig("names", "samples name x1 otherwise", STALE, "names y1, a1, but not x1"),
    _rig("sizes", "samples have one position for two names", STALE, "has 1 values for 2 names"),
    Fault("twice", "The rig and its driver", "every sample is sent twice", Spoiled("twice"),
          status=1, words="samples of plant/state came twice"),
    _rig("old", "stamps are 1 s in the past", LATE, "stamped 1.0"),
    _rig("ahead", "stamps are a day in the future", ("age",), "s in the future"),
    *(_silent(seconds) for seconds in (0.1, 1.0, 5.0)),
)  # fmt: skip
NETWORK = (
    *(_cable(seconds) for seconds in (0.1, 1.0, 5.0, 10.0)),
    Fault("rival-state", "The network", "a second publisher of plant/state", Rival("plant/state"),
          ("owner",), words="plant/state has "),
    Fault("rival-command", "The network", "a second publisher of actuator/command", Rival("actuator/command"),
          ("owner",), words="actuator/command has "),
    Fault("rival-reference", "The network", "a second publisher of numerical/force_reference",
          Rival("numerical/force_reference"), ("owner",), words="numerical/force_reference has "),
    Fault("second-run", "The network", "a second run in the same domain", SecondRun(), status=0),
)  # fmt: skip
KILLED = "was killed by SIGKILL"
NO_STATE = "plant/state has had no fresh sample"
NODES = (
    _part("driver-killed", Sent("driver", SIGKILL), STALE, 3, NO_STATE),
    _part("driver-stopped", Sent("driver", SIGSTOP), STALE, 3, NO_STATE),
    _part("plant-killed", Sent("plant", SIGKILL), ("node",), 1, f"plant {KILLED}"),
    _part("plant-stopped", Sent("plant", SIGSTOP), STALE, 3, NO_STATE),
    _part("numerical-killed", Sent("numerical", SIGKILL), ("node", "stale"), 1, f"numerical {KILLED}"),
    _part("numerical-stopped", Sent("numerical", SIGSTOP), ("stale", "age", "heartbeat"), 3, "numerical"),
    _part("controller-killed", Sent("controller", SIGKILL), ("node",), 1, f"actuator {KILLED}"),
    _part("controller-stopped", Sent("controller", SIGSTOP), BEAT, 3, "actuator has been silent for"),
    _part("controller-stalled", Sent("controller", SIGSTOP, 1.0), BEAT, 3, "actuator has been silent for"),
    Fault("controller-late", "Parts of the test", "the controller is stopped for 1 s where limits allow 2 s",
          Sent("controller", SIGSTOP, 1.0), BEAT, given={"stale": 2.0, "heartbeat": 2.0}),
    _part("recorder-killed", Sent("recorder", SIGKILL), ("node",), 1, f"recorder {KILLED}", "bag"),
    _part("recorder-stopped", Sent("recorder", SIGSTOP), BEAT, 3, "recorder has been silent for"),
    _part("analysis-killed", Sent("analysis", SIGKILL), (), 1, f"analysis {KILLED}"),
    _part("analysis-stopped", Sent("analysis", SIGSTOP), (), 1, "analysis"),
    _part("leader-killed", Sent("leader", SIGKILL), (), None, ""),
    _part("leader-stopped", Sent("leader", SIGSTOP, 2.0), (), 1, "The leader stalled for"),
)  # fmt: skip
HOST = (
    Fault("disk", "The host", "the disk for the recording is full", Disk(1_000_000),
          ("node",), 1, "no space is left in", unwritten=("bag", "page")),
    _memory("numerical", ("node", "stale"), 1, "MemoryError"),
    _memory("controller", ("node",), 1, "MemoryError"),
    _memory("recorder", (), 0, ""),
    *(Fault(f"operator-{way}", "The operator", what, Operator(way), limits, words=words)
      for way, what, limits, words in (
          ("service", "he aborts by the service", ("operator",), "asked for by the service actuator/abort"),
          ("topic", "he aborts by the topic", ("operator",), "asked for by the topic abort"),
          ("heartbeat", "his heartbeat ends", BEAT, "the operator's heartbeat has been silent"))),
)  # fmt: skip
FAULTS = (*RIG, *NETWORK, *NODES, *HOST)
