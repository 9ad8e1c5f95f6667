"""The zero of a rig's sensors at the begin of a test: its driver is told it, or the test is refused."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.stopped import StoppedError
from rthm_core.limits import kept_limits
from rthm_core.topics import PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.spec import Spec

ANSWER = 2.0
"""How long a driver that need not know offsets may take to say so, s."""

Values = dict[str, tuple[float, ...]]


def zero_of(spec: Spec) -> Values:
    """What a driver has to subtract from its readings, by parameter; zeros where the spec has nothing."""
    loop = spec.loop()
    sizes = {"position": loop.plant.n, "velocity": loop.plant.n}
    sizes |= dict.fromkeys(("motor", "force"), len(loop.actuator.names))
    given = spec.zero.model_dump() if spec.zero else {}
    return {f"zero.{name}": tuple(given.get(name) or (0.0,) * size) for name, size in sizes.items()}


def tell_zero(conductor: Conductor, spec: Spec) -> None:
    """Tell the driver what to subtract; one that takes no offsets is right where there are none.

    Raises
    ------
    StoppedError
        When the spec has offsets and the driver does not take them.
    """
    told = zero_of(spec)
    needed = any(map(any, told.values()))
    drivers = _drivers(conductor)
    if not needed:
        with suppress(StoppedError):
            conductor.set(dict.fromkeys(drivers, told), ANSWER)
        return
    try:
        if not drivers:
            raise StoppedError("no node has the name of its publisher")
        conductor.set(dict.fromkeys(drivers, told))
    except StoppedError as stopped:
        raise StoppedError(
            f"The spec has a zero of the sensors, and the driver does not subtract it ({stopped});"
            " give the driver these parameters, or subtract it there and take it out of the spec."
        ) from stopped


def _drivers(conductor: Conductor) -> list[str]:
    """Names of the nodes that publish the state; an endpoint is known a moment before its name."""
    with suppress(StoppedError):
        conductor.wait_until(lambda: bool(conductor.publishers(PLANT_STATE)), ANSWER, str)
    return conductor.publishers(PLANT_STATE)


def check_tension(spec: Spec) -> None:
    """Refuse a rig whose wires have a pretension by the spec that nobody has measured.

    Raises
    ------
    StoppedError
        With the figures of the wire.
    """
    actuator, allowed = spec.loop().actuator, (kept_limits(spec, hardware=True).start or (0.0, 0.0))[1]
    measured = (spec.zero.tension if spec.zero else None) or (None,) * len(actuator.names)
    for name, wanted, found in zip(actuator.names, actuator.pretension, measured, strict=True):
        if wanted and (found is None or abs(found - wanted) > allowed):
            was = "was not measured" if found is None else f"was measured as {found:.4g} N"
            raise StoppedError(
                f"Not armed, and nothing was moved: the pretension of {name} is {wanted:.4g} N by the spec"
                f" and {was}, where limits.start allows {allowed:.4g} N. Approach it with rthm pretension."
            )
