"""How well every recorded signal is simulated on unseen data, over the runs and in one free run."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.physical.judged import Simulated, nrmse, spread
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.zeros_told import zeros_in
from rthm_analysis.diagnosis.replay.evidence import MOTION
from rthm_analysis.diagnosis.replay.windows import Windows, state_at
from rthm_analysis.diagnosis.result import Fit, FreeRun, RecordingFit

SIGNAL_OF = {
    "plant": "position",
    "wire": "force",
    "motor": "motor",
    "sensor.position": "position",
    "sensor.velocity": "velocity",
    "sensor.acceleration": "acceleration",
    "sensor.force": "force",
}

BLOCK_OF = dict.fromkeys(MOTION, "plant") | {"force": "wire"}


def channel_of(physical: Physical, block: str) -> int | None:
    """First channel that shows a block's output."""
    family = SIGNAL_OF[block]
    found = [i for i, c in enumerate(physical.evidence.channels) if c.family == family]
    return found[0] if found else None


def fits_of(physical: Physical, runs: dict[str, Simulated], blocks: set[str]) -> tuple[Fit, ...]:
    """One fit for each located block's output, then one for every other recorded signal."""
    told = {block: k for block in sorted(blocks) if (k := channel_of(physical, block)) is not None}
    rows = list(told.items())
    rows += [
        (BLOCK_OF[c.family], k) for k, c in enumerate(physical.evidence.channels) if k not in told.values()
    ]
    return tuple(_fit(physical, runs, block, k) for block, k in rows)


def _fit(physical: Physical, runs: dict[str, Simulated], block: str, k: int) -> Fit:
    time, train = physical.evidence.time, physical.train
    held = slice(train, None)
    return Fit(
        block,
        physical.evidence.channels[k].signal,
        physical.windows.length,
        (0.0, float(time[train])),
        (float(time[train]), float(time[-1])),
        _errors(physical, runs, k),
        time[held],
        physical.evidence.measured[held, k],
        runs["nominal"].predicted[held, k],
        runs["retuned"].predicted[held, k],
        runs["explained"].predicted[held, k],
    )


def recording_fits(physical: Physical, runs: dict[str, Simulated]) -> tuple[RecordingFit, ...]:
    """How well each of several recordings is simulated; none where there is one only."""
    evidence = physical.evidence
    if len(evidence.names) < 2:
        return ()
    several = zip(evidence.names, evidence.spans, evidence.recordings, strict=True)
    return tuple(
        RecordingFit(
            name,
            span,
            samples.start >= physical.train,
            {c.signal: _errors(physical, runs, k, samples) for k, c in enumerate(evidence.channels)},
            zeros_in(physical.own_zeros, recording),
        )
        for recording, (name, span, samples) in enumerate(several)
    )


def _errors(
    physical: Physical, runs: dict[str, Simulated], k: int, samples: slice | None = None
) -> dict[str, float]:
    """Errors of a channel and its noise over its standard deviation, by default in the unseen part."""
    found = {name: nrmse(physical, run.predicted, k, samples) for name, run in runs.items()}
    return found | {"noise_floor": float(physical.noise.level[k]) / spread(physical, k, samples)}


def free_runs(physical: Physical, runs: dict[str, Simulated]) -> dict[str, FreeRun]:
    """One free run over the unseen part from the state at its start, for every recorded position."""
    evidence, train = physical.evidence, physical.train
    found = {}
    errors = {name: _free_errors(physical, run) for name, run in runs.items()}
    for k, channel in enumerate(evidence.channels):
        if channel.family == "position":
            seconds = float(evidence.time[-1] - evidence.time[train])
            found[channel.place] = FreeRun(
                seconds, *(errors[name][k] for name in ("nominal", "retuned", "explained"))
            )
    return found


def _free_errors(physical: Physical, run: Simulated) -> list[float]:
    """Error of each channel over its spread; that of the run over everything where there is just one."""
    if physical.windows.length is None:
        predicted = run.predicted
    else:
        spec, evidence = run.fitted.model.spec, physical.evidence
        state = state_at(evidence, spec, physical.train)
        start = np.array([0, physical.train])
        once = Windows(start, np.stack([physical.windows.state[0], state]), 0.0)
        physical.experiment.begin_at(evidence.stamps_ns[np.union1d(physical.windows.start, start)])
        predicted = physical.experiment.predicted(spec, once)
    return [nrmse(physical, predicted, k) for k in range(len(physical.evidence.channels))]
