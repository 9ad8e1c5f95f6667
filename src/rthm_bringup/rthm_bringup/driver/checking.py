"""A driver checked from end to end: environment, listening, judging."""

from __future__ import annotations

import math
import os
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from rthm_bringup.driver.check import Check
from rthm_bringup.run.environment import Network
from rthm_bringup.run.shared_memory import Caretaker
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def check_driver(
    spec: Spec, network: Network, seconds: float, patience: float, distance: float = 0.0
) -> tuple[Check, ...]:
    """Listen to whatever publishes ``plant/state`` for `seconds` and judge it.

    Parameters
    ----------
    patience
        How long to wait for a first sample, s.
    distance
        Swing of all motors meanwhile, m; 0: nothing is commanded.

    Raises
    ------
    InputError
        If the spec describes a plant alone, or the swing would pass one of its limits.
    """
    if not math.isfinite(distance):
        raise InputError(f"The swing is {distance} m, but must be finite; give a distance.")
    with TemporaryDirectory() as log, Caretaker():
        os.environ.update(network.variables() | {"ROS_LOG_DIR": log})
        from rthm_bringup.driver.checks import checks_of
        from rthm_bringup.driver.listener_node import listen  # ROS reads its environment when imported

        return checks_of(listen(spec, network, seconds, patience, distance), spec)
