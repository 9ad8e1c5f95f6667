"""Limits of a test as they are kept: the spec's, with what is compulsory and what has a default."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.spec import LimitsSpec, Spec

COMPULSORY = ("command", "rate", "force", "stale", "ramp")
"""Without these nothing moves a real machine."""
START = 0.01
"""Difference between rig and spec that is allowed at the start: share of `command`, and of `force`."""
STEPS = 2.0
"""How much faster than `rate` a measured position may step from sample to sample."""
FROZEN, HOLD = 0.25, 0.5
"""How long a sensor may not change, and a command be at a limit, s."""
FROZEN_TRAVEL = 0.001
"""How far the command moves before a sensor has to: share of `command`; coarse digits stand for less."""
HEARTBEAT, PATIENT_HEARTBEAT = 0.2, 2.0
"""Longest silence of a node beside a real machine, and beside a simulated one, s."""


def limit_units(*names: str) -> dict[str, str]:
    """Units of some limits, as the spec declares them.

    Examples
    --------
    >>> limit_units("rate", "following")
    {'rate': 'm/s', 'following': 'm'}
    """
    from rthm_core.spec import LimitsSpec

    declared = dict(LimitsSpec.entries())
    return {name: declared[name].unit for name in names}


def require_limits(spec: Spec) -> None:
    """Refuse a spec with which no real machine may be moved.

    Raises
    ------
    InputError
        If a compulsory limit is missing.
    """
    missing = [name for name in COMPULSORY if spec.limits is None or getattr(spec.limits, name) is None]
    if missing:
        keys = (
            f"limits.{', '.join(missing[:-1])} and {missing[-1]}" if missing[1:] else f"limits.{missing[0]}"
        )
        raise InputError(
            f"{keys} {'are' if missing[1:] else 'is'} missing, but must be given where the plant is a real"
            f" machine, as all of {', '.join(COMPULSORY)} must; add what is missing to the spec."
        )


def kept_limits(spec: Spec, hardware: bool) -> LimitsSpec:
    """Limits of a spec with their defaults.

    Parameters
    ----------
    spec
        A complete loop.
    hardware
        Whether the plant is a real machine: then no limit that has a default is off.
    """
    from rthm_core.spec import LimitsSpec

    limits = spec.limits or LimitsSpec()
    filled: dict[str, float | tuple[float, float] | None] = {
        "age": limits.stale,
        "command_age": limits.stale,
        "heartbeat": PATIENT_HEARTBEAT,
    }
    if hardware:
        require_limits(spec)
        assert limits.command is not None
        assert limits.force is not None
        assert limits.rate is not None
        filled |= {
            "start": (START * limits.command, START * limits.force),
            "step": STEPS * limits.rate * spec.loop().timing.td1,
            "frozen": FROZEN,
            "hold": HOLD,
            "heartbeat": HEARTBEAT,
        }
    return limits.model_copy(
        update={name: value for name, value in filled.items() if getattr(limits, name) is None}
    )
