"""What was found about a block that computes, for a test engineer."""

from __future__ import annotations

from rthm_analysis.diagnosis.numbers import number, percent, with_unit
from rthm_analysis.diagnosis.result import Value
from rthm_core.compensators import declared
from rthm_core.spec import Spec

WHO = {"controller": "controller", "numerical": "numerical substructure"}


def wrong(block: str, name: str, nominal: float, value: Value, share: float, runner_up: str) -> str:
    """Sentence for a wrong parameter.

    Parameters
    ----------
    share : float
        Part of the squared error of the block's output, on unseen data, that it removes.
    runner_up : str
        Next best explanation, in words; empty: there is none.
    """
    change = f" ({100.0 * (value.value / nominal - 1.0):+.2f} %)" if nominal else ""
    found = f"{name} = {number(value.value, value.std, value.unit, signed=True)}"
    removed = f"{percent(max(share, 0.0))} of the squared error of its output"
    return (
        f"The {WHO[block]} computes with {found}; the spec says {with_unit(nominal, value.unit, 6)}{change}. "
        f"On the last third of the recording this removes {removed}.{runner_up}"
    )


def second_best(name: str, times: float) -> str:
    """Sentence on the next best parameter, which leaves `times` the error."""
    return f" The next best explanation, {name}, leaves {times:.3g} times the error."


def not_one(block: str, nominal: float, left: float) -> str:
    """Sentence for an error that no parameters explain."""
    return (
        f"The {WHO[block]} does not compute what the spec says: its output is off by {percent(nominal)} "
        f"of its rms, and no other value of one of its parameters brings that below {percent(left)}."
    )


def other_law(actuator: str, gains: tuple[float, float, float], compliance: float) -> str:
    """Sentence for a controller with another law."""
    position, force, constant = gains
    return (
        f"The controller computes the command of {actuator} as {position:.5g} x1 + {force:.5g} m/N F_d "
        f"{constant:+.3g} m; by the spec it is x1 + {compliance:.5g} m/N F_d."
    )


def unlike(actuator: str, share: float, error: float) -> str:
    """Sentence for commands that follow no such law."""
    return (
        f"{percent(share)} of the commands of {actuator} are not x1 + F_d / k_tot of the samples that "
        f"the controller used; they are off by {1e3 * error:.3g} mm rms. The reason could be limits of the "
        "safety monitor, a compensator, or another law."
    )


def compensator(spec: Spec) -> str:
    """A controller's compensator in a sentence."""
    actuator = spec.loop().actuator
    kind = declared(actuator.compensator)
    if kind is not None and not kind.predicts:
        return "one without a compensator"
    order = f" of order {actuator.compensator_order}" if kind is not None and kind.orders else ""
    ahead = actuator.compensator_horizon
    horizon = "" if ahead is None else f" that looks {1e3 * ahead:.6g} ms ahead"
    return f"one with the compensator {actuator.compensator}{order}{horizon}"


def wrong_compensator(spec: Spec, right: Spec, name: str) -> str:
    """Sentence for another compensator than the spec's; `name` is the entry that is wrong."""
    value = getattr(spec.loop().actuator, name.removeprefix("actuator."))
    said = "nothing" if value is None else value
    found = compensator(right).replace("one", "a controller", 1)
    return (
        f"The spec says {name}: {said}, but the recorded commands are those of {found}. "
        "Compare the actuator section of the spec with what the controller was started with; all else here "
        "assumes the compensator found."
    )


def no_compensator(spec: Spec) -> str:
    """Sentence for commands that no known compensator gives."""
    return (
        f"The spec says that the controller is {compensator(spec)}, but neither this one nor any other known "
        "compensator, of any order and horizon, gives the recorded commands from the samples that it used. "
        "Compare program and spec of the controller with those of the test."
    )
