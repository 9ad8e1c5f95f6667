"""What a diagnosis says: plain data that the command line, the report and the node pass on."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, Literal

from rthm_core.effects import effect
from rthm_core.effects.registry import changing
from rthm_core.spec.effect import placed

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

Verdict = Literal["match", "retuned", "explained", "improved", "unexplained"]


@dataclass(frozen=True)
class Value:
    """A number that was found, its standard deviation, and the unit of both."""

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class Physics:
    """One effect that was found.

    Attributes
    ----------
    block, kind
        Where and what (contract, section 6).
    place : str or None
        Dof or actuator that has it; None in blocks that are one thing.
    parameters : dict
        Numbers as `Value`; an entry that is text (the name of a wrong parameter) as str.
    words : str
        What, where, how big, how sure, for a test engineer.
    energy : float
        Work that it did on the moving masses over the recording, J; + introduced. NaN: not known.
    share : float
        Part of the retuned model's squared error on unseen data that it removes.
    """

    block: str
    kind: str
    place: str | None
    parameters: dict[str, Value | str]
    words: str
    energy: float
    share: float


@dataclass(frozen=True)
class Fault:
    """What is wrong with the recording, or with the spec it is compared with, rather than with the rig.

    Attributes
    ----------
    block : str
        Where it shows: that of the sensor or link; ``plant`` for a load and for a spec of another rig.
    kind : str
        ``sign``, ``unit``, ``swapped``, ``channel_delay``, ``stuck``, ``spikes``, ``dropout``, ``hum``,
        ``rectified``, ``saturation``, ``nonlinear`` (of a sensor), ``wander`` (of its zero),
        ``clock_drift``, ``offset`` (that differs from recording to recording), ``wrong_parameter`` (of
        timing or compensator), ``wrong_spec``, ``stray`` (of what was recorded for a moment),
        ``force_lag``, ``force_leak``, ``crosstalk``.
    channel : str
        ``x1.velocity``, ``a1.effort``, ``timing.tau1``, ``actuator.compensator``.
    words : str
        What, where and when, for a test engineer, with the way out.
    interval : (float, float) or None
        Seconds since the start of the test from its beginning to its end; None: throughout.
    value : float or None
        Its size: the factor of a unit, seconds of a delay, the value that a parameter really had.
    marked : bool
        Whether the recording itself says so, as a gap that is NaN: such a fault changes no verdict.
    """

    block: str
    kind: str
    channel: str
    words: str
    interval: tuple[float, float] | None = None
    value: float | None = None
    marked: bool = False


WRONG_ENTRY = changing("controller", "entry").kind
"""Kind of a fault of timing or compensator, which is called as that of a block that computes with another
value."""


def wrong_entry(block: str, name: str, words: str, value: float | None) -> Fault:
    """An entry of the spec with which the test was not run, and the value that it really had."""
    return Fault(block, WRONG_ENTRY, name, words, None, value)


@dataclass(frozen=True)
class Described:
    """A force that no kind fits but the data show.

    Attributes
    ----------
    block, place
        Where it acts; between two dofs the place names both.
    depends_on : tuple of str
        Of ``x v a t u command load``.
    symmetry : str
        ``odd``, ``even`` or ``neither``.
    dissipative, memory : bool
        Whether it takes energy out, and whether it depends on the past.
    interval : (float, float) or None
        When it acts, s since the start of the test; None: throughout.
    formula : str or None
        In N, where one was earned.
    domain : dict
        Range of each variable in which it was seen.
    share, held_out_gain : float
        Part of the squared error that it removes, on all data and on data that chose nothing.
    at, force, std : (n,) arrays
        The curve over the first variable, as the recording has it, in `unit`.
    words : str
    law : pair of (s,) arrays or None
        First variable and force of the formula at single samples.
    unit : str
        ``N``; of a motor's error ``m``.
    """

    block: str
    place: str
    depends_on: tuple[str, ...]
    symmetry: str
    dissipative: bool
    memory: bool
    interval: tuple[float, float] | None
    formula: str | None
    domain: dict[str, tuple[float, float]]
    share: float
    held_out_gain: float
    at: Floats
    force: Floats
    std: Floats
    words: str
    law: tuple[Floats, Floats] | None = None
    unit: str = "N"


@dataclass(frozen=True)
class Trace:
    """An effect that the data show but that does not matter: `share` of the squared error below 1 %."""

    block: str
    kind: str
    share: float
    words: str


@dataclass(frozen=True)
class Refused:
    """A hypothesis that was tried and not taken, and why, in words."""

    block: str
    kind: str
    words: str


@dataclass(frozen=True)
class FreeRun:
    """Error of one free run over the unseen part, over the standard deviation of the dof's position there."""

    seconds: float
    nominal: float
    retuned: float
    explained: float


@dataclass(frozen=True)
class Mismatch:
    """One-block prediction error of a block, over its own noise floor (1: explained by noise)."""

    block: str
    mismatch: float
    significant: bool


@dataclass(frozen=True)
class Retuned:
    """An uncertain parameter of the spec and its value in this recording, in the unit of the spec."""

    nominal: float
    value: float
    std: float
    unit: str = ""


@dataclass(frozen=True)
class Alternative:
    """Another kind that was tried; `distinguishable`: the recording tells it from what was named."""

    block: str
    kind: str
    held_out_nrmse: float
    distinguishable: bool


@dataclass(frozen=True)
class Fit:
    """How well a block's output is simulated on data that had no part in any selection or fit.

    Attributes
    ----------
    block, signal
        Which output of which block.
    window : float or None
        Seconds of each free run; None: one run over the whole part.
    train, held_out : (float, float)
        Seconds since the start of the test.
    nrmse : dict
        Error over the signal's standard deviation there: ``nominal``, ``retuned``, ``explained``,
        ``noise_floor``.
    time, recorded, nominal, retuned, explained : (n,) arrays
        The signal over the held-out part and its simulations, for pictures; empty where there are none.
    """

    block: str
    signal: str
    window: float | None
    train: tuple[float, float]
    held_out: tuple[float, float]
    nrmse: dict[str, float]
    time: Floats | None = None
    recorded: Floats | None = None
    nominal: Floats | None = None
    retuned: Floats | None = None
    explained: Floats | None = None


@dataclass(frozen=True)
class RecordingFit:
    """How well one of several recordings is simulated.

    Attributes
    ----------
    name : str
    interval : (float, float)
        Its begin and end where times of the answer are those of the recordings one after the other, s.
    held_out : bool
        Whether it had no part in any selection or fit, but for the state in which it begins.
    nrmse : dict of dict
        By signal: error over its standard deviation in this recording, with the keys of `Fit.nrmse`.
    offsets : dict of Value
        By signal whose zero differs from recording to recording (``x1``, ``load_x1``): what it reads in this
        one at a true value of zero.
    """

    name: str
    interval: tuple[float, float]
    held_out: bool
    nrmse: dict[str, dict[str, float]]
    offsets: dict[str, Value] = field(default_factory=dict)


@dataclass(frozen=True)
class Curve:
    """The force that the model without the named physics lacks, averaged over one variable.

    Attributes
    ----------
    block : str
    variable : str
        Abscissa: ``x``, ``v``, ``t``, of a wire ``u - x`` or ``du/dt - v``.
    unit : str
        Its unit.
    at, force, std : (n,) arrays
        Abscissa, force (N, as seen by the block's output) and its standard deviation.
    law : pair of (s,) arrays or None
        Abscissa and force of the named physics at single samples: jumps and loops stay what they are.
    improvement : float
        Part of the variance of the force that the averages explain.
    """

    block: str
    variable: str
    unit: str
    at: Floats
    force: Floats
    std: Floats
    law: tuple[Floats, Floats] | None
    improvement: float


@dataclass(frozen=True)
class Limit:
    """Smallest size of an effect that would have been seen."""

    value: float
    unit: str


@dataclass(frozen=True)
class Part:
    """What the diagnosis of some blocks found; a `Diagnosis` joins all parts.

    `changes` are what the spec needs (``rthm_core.spec.apply``) so that the simulator behaves as recorded;
    `effects` are named sections to add, as dicts with block, kind, place and parameters.
    """

    blocks: tuple[Mismatch, ...] = ()
    physics: tuple[Physics, ...] = ()
    retuned: dict[str, Retuned] = field(default_factory=dict)
    alternatives: tuple[Alternative, ...] = ()
    fits: tuple[Fit, ...] = ()
    detection_limits: dict[str, Limit] = field(default_factory=dict)
    curves: tuple[Curve, ...] = ()
    changes: dict[str, Any] = field(default_factory=dict)
    effects: tuple[dict[str, Any], ...] = ()
    unexplained: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    faults: tuple[Fault, ...] = ()
    described: tuple[Described, ...] = ()
    traces: tuple[Trace, ...] = ()
    refused: tuple[Refused, ...] = ()
    free_run: dict[str, FreeRun] = field(default_factory=dict)
    recordings: tuple[RecordingFit, ...] = ()

    @classmethod
    def joined(cls, parts: Iterable[Part]) -> Part:
        """What some parts found, in their order; of two with one name the later one counts."""
        found: dict[str, Any] = vars(cls()).copy()
        for part in parts:
            for name, more in vars(part).items():
                found[name] = found[name] | more if isinstance(more, dict) else found[name] + more
        return cls(**found)


@dataclass(frozen=True)
class Diagnosis:
    """Everything that `diagnose` found out (contract, section 7)."""

    verdict: Verdict
    blocks: tuple[Mismatch, ...]
    located: tuple[str, ...]
    physics: tuple[Physics, ...]
    retuned: dict[str, Retuned]
    alternatives: tuple[Alternative, ...]
    fits: tuple[Fit, ...]
    detection_limits: dict[str, Limit]
    next_experiment: str
    words: str
    curves: tuple[Curve, ...] = ()
    unexplained: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    patched: str = ""
    faults: tuple[Fault, ...] = ()
    described: tuple[Described, ...] = ()
    traces: tuple[Trace, ...] = ()
    refused: tuple[Refused, ...] = ()
    free_run: dict[str, FreeRun] = field(default_factory=dict)
    next_experiment_spec: str | None = None
    """Text of a spec that runs `next_experiment`, where that is a test of the rig."""
    recordings: tuple[RecordingFit, ...] = ()
    """Where several were diagnosed together."""
    next_experiment_gain: float | None = None
    """Smallest rms difference between what the surviving hypotheses predict of it, in units of the noise."""

    def as_dict(self) -> dict[str, Any]:
        """Keys of contract section 7, and `words`, `unexplained`, `curves`, `notes`."""
        return {
            "verdict": self.verdict,
            "words": self.words,
            "blocks": [asdict(one) for one in self.blocks],
            "located": list(self.located),
            "physics": [_physics(one) for one in self.physics],
            "retuned": {name: asdict(one) for name, one in self.retuned.items()},
            "alternatives": [asdict(one) for one in self.alternatives],
            "fits": [_fit(one) for one in self.fits],
            "detection_limits": {name: asdict(one) for name, one in self.detection_limits.items()},
            "next_experiment": self.next_experiment,
            "next_experiment_spec": self.next_experiment_spec,
            "next_experiment_gain": self.next_experiment_gain,
            "unexplained": list(self.unexplained),
            "curves": [_curve(one) for one in self.curves],
            "notes": list(self.notes),
            "faults": [asdict(one) for one in self.faults],
            "described": [_described(one) for one in self.described],
            "traces": [asdict(one) for one in self.traces],
            "refused": [asdict(one) for one in self.refused],
            "free_run": {dof: asdict(one) for dof, one in self.free_run.items()},
            "recordings": [asdict(one) for one in self.recordings],
        }


def _placed(block: str, place: str | None) -> dict[str, Any]:
    return {"relative_to": None} | ({} if place is None else placed(block, place))


def _physics(one: Physics) -> dict[str, Any]:
    parameters = {k: v if isinstance(v, str) else asdict(v) for k, v in one.parameters.items()}
    place = _placed(one.block, one.place)
    head = {"block": one.block, "kind": one.kind, **place, "parameters": parameters}
    variables = list(effect(one.kind, one.block).depends_on)
    reach = {"depends_on": variables, "interval": None}
    return {**head, **reach, "words": one.words, "energy": one.energy, "share": one.share}


def _fit(one: Fit) -> dict[str, Any]:
    return {
        "block": one.block,
        "signal": one.signal,
        "window": one.window,
        "train": list(one.train),
        "held_out": list(one.held_out),
        "nrmse": one.nrmse,
    }


def _described(one: Described) -> dict[str, Any]:
    values = {f.name: getattr(one, f.name) for f in fields(one)}
    curve = {name: values.pop(name).tolist() for name in ("at", "force", "std")}
    place = _placed(one.block, values.pop("place"))
    del values["law"]
    return {**place, **values, "depends_on": list(one.depends_on), "curve": curve}


def _curve(one: Curve) -> dict[str, Any]:
    arrays = {"at": one.at, "force": one.force, "std": one.std}
    return {
        "block": one.block,
        "variable": one.variable,
        "unit": one.unit,
        "improvement": one.improvement,
        **{name: values.tolist() for name, values in arrays.items()},
    }
