"""A run with all that belongs to it: folders, environment, session, analysis, report."""

from __future__ import annotations

import os
from signal import SIGINT, SIGTERM

from rthm_bringup.interruption import interrupted_by
from rthm_bringup.run.environment import ros_in_words
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.result import Result, result_of
from rthm_bringup.run.shared_memory import Caretaker
from rthm_bringup.run.view import View
from rthm_core.ros import system
from rthm_core.ros.reach import HOST


def perform(plan: Plan) -> Result:
    """Run a test and analyse its recording.

    Raises
    ------
    InputError
        The output folder cannot be written.
    """
    plan.lay_out()
    os.environ.update(plan.network.variables() | {"ROS_LOG_DIR": str(plan.log.absolute())})
    with Caretaker(), View() as view, interrupted_by(SIGINT, SIGTERM):
        from rthm_bringup.run.session import Session  # ROS reads its environment when it is first imported

        view.note(f"{ros_in_words()}, {plan.network.place()}, {plan.out}")
        if plan.network.reach != HOST:
            view.note(f"network: {plan.network.words()}")
        ending = Session(plan, view).run()
        system.as_usual()
        view.phase("analysing the recording")
        return result_of(plan, ending)
