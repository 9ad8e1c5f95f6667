"""What was found about a block that computes, for a test engineer."""

from __future__ import annotations

from rthm_analysis.diagnosis.result import Value

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
    percent = f", {100.0 * (value.value / nominal - 1.0):+.2f} %" if nominal else ""
    found = f"{name} = {value.value:.6g} {value.unit} (+- {value.std:.2g})"
    removed = f"{100.0 * max(share, 0.0):.4g} % of the squared error of its output"
    return (
        f"The {WHO[block]} computes with {found} instead of {nominal:.6g} {value.unit} as the spec "
        f"says{percent}. On the last third of the recording this removes {removed}.{runner_up}"
    )


def second_best(name: str, times: float) -> str:
    """Sentence on the next best parameter, which leaves `times` the error."""
    return f" The next best explanation, {name}, leaves {times:.3g} times the error."


def not_one(block: str, nominal: float, left: float) -> str:
    """Sentence for an error that no parameters explain."""
    return (
        f"The {WHO[block]} does not compute what the spec says: its output is off by {100.0 * nominal:.3g} % "
        f"of its rms, and no other value of its parameters brings that below {100.0 * left:.3g} %."
    )


def other_law(actuator: str, gains: tuple[float, float, float], compliance: float) -> str:
    """Sentence for a controller with another law."""
    position, force, constant = gains
    return (
        f"The controller computes the command of {actuator} as {position:.5g} x1 + {force:.5g} m/N F_d "
        f"{constant:+.3g} m; the spec says 1 x1 + {compliance:.5g} m/N F_d."
    )


def unlike(actuator: str, share: float, error: float) -> str:
    """Sentence for commands that follow no such law."""
    return (
        f"{100.0 * share:.3g} % of the commands of {actuator} are not x1 + F_d / k_tot of the samples that "
        f"the controller used, by {1e3 * error:.3g} mm rms; limits of the safety monitor, a compensator or "
        "another law could be the reason."
    )
