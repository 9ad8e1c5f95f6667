"""Fits of the paper's physical side to a recording of one that differs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import windows
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec

from .side import EVIDENCE, PAPER, simulated

SIGMA = np.array([1e-4, 2e-3, 0.02])
"""Reference noise of position, velocity and force."""


FAMILIES = ("position", "velocity", "force")


def fitting_of(true: Spec, seed: int, *families: str) -> Fitting:
    """Fits of the paper's physical side to a recording of another one; only some channels, or all."""
    noise = np.random.default_rng(seed).normal(size=(EVIDENCE.stamps_ns.size, 4)) * [*SIGMA, 1e-5]
    seen = replace(EVIDENCE, measured=simulated(true) + noise).only(*families or FAMILIES)
    runs = windows(seen, PAPER, True)
    return Fitting(Experiment(seen, first_command(PAPER)), runs, SIGMA[: len(seen.channels)], Model(PAPER))
