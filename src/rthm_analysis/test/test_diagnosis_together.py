"""Several recordings of one rig: one model, a beginning for each, and the last confirms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.joining import joined
from rthm_analysis.diagnosis.names import check_one_rig
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.joint import one_after_the_other
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_analysis.diagnosis.result import Diagnosis
from rthm_core.errors import InputError
from rthm_core.spec import apply

from .plain import plant, recorded
from .side import COMMANDS, EVIDENCE, STAMPS, having, simulated

NO_MOTORS = np.empty(0)


def together(*evidences: Evidence) -> Evidence:
    names = [f"test{i + 1}" for i in range(len(evidences))]
    return one_after_the_other(evidences, names, NO_MOTORS)


def diagnosed(evidence: Evidence, **uncertainty: float) -> Diagnosis:
    found = diagnose_physical(evidence, plant(**uncertainty), NO_MOTORS, lambda said: None)
    return joined([physical_part(found)], plant(**uncertainty))


def test_a_replay_of_several_is_that_of_each() -> None:
    one, other = (recorded(duration=3.0, seed=seed, force=0.2 + seed) for seed in (0, 1))
    spec = apply(
        plant(), {"effects": ["d"], "d": {"block": "plant", "kind": "quadratic_drag", "coefficient": 0.3}}
    )
    both = together(one, other)
    runs = windows(both, spec, known_start=False)
    assert runs.start.tolist() == [0, 601] and runs.length is None
    still = replace(runs, state=np.zeros((2, 2)))
    experiment = Experiment(both, NO_MOTORS)
    experiment.begin_at(both.stamps_ns[still.start])
    alone = Windows(np.zeros(1, dtype=np.int64), np.zeros((1, 2)), None)
    each = [Experiment(e, NO_MOTORS).predicted(spec, alone) for e in (one, other)]
    assert np.allclose(experiment.predicted(spec, still), np.vstack(each), rtol=0.0, atol=1e-12)


def test_motors_go_back_to_where_a_test_begins() -> None:
    measured = simulated(having("plant", "coulomb_friction", force=0.05))
    one = replace(EVIDENCE, measured=measured)
    first = COMMANDS[0] * 0.0 + 0.5
    both = one_after_the_other([one, one], ["a", "b"], first)
    spec = having("plant", "coulomb_friction", force=0.05, poles=True)
    runs = windows(both, spec, known_start=True)
    experiment = Experiment(both, first)
    experiment.begin_at(both.stamps_ns[runs.start])
    found = experiment.predicted(spec, runs)
    assert np.allclose(found[: STAMPS.size], found[STAMPS.size :], rtol=0.0, atol=1e-9)


def test_what_only_several_levels_tell_is_named_and_the_last_confirms_it() -> None:
    """At each level by itself a spring that stiffens is a stiffness."""
    levels = [
        recorded(lambda t, x, v: -40.0 * x**3, duration=12.0, seed=i, force=force)
        for i, force in enumerate((0.1, 0.6, 0.4))
    ]
    found = diagnosed(together(*levels), stiffness=0.05)
    assert found.verdict == "explained"
    assert [one.kind for one in found.physics] == ["cubic_stiffness"]
    coefficient = found.physics[0].parameters["coefficient"]
    assert abs(coefficient.value - 40.0) < 4.0 * coefficient.std < 1.0
    assert [one.held_out for one in found.recordings] == [False, False, True]
    for one in found.recordings:
        assert one.nrmse["x1"]["explained"] < 1.3 * one.nrmse["x1"]["noise_floor"]
    assert found.recordings[2].nrmse["x1"]["nominal"] > 10.0 * found.recordings[2].nrmse["x1"]["noise_floor"]


def test_what_only_the_last_shows_is_not_explained() -> None:
    low = recorded(duration=12.0, seed=0, force=0.6)
    high = recorded(lambda t, x, v: -0.05 * np.sign(v), duration=12.0, seed=1, force=0.6)
    found = diagnosed(together(low, high))
    assert found.verdict in ("improved", "unexplained") and not found.physics


def test_nothing_is_missing_in_two_clean_recordings() -> None:
    found = diagnosed(together(*(recorded(duration=12.0, seed=i, force=0.3 * (i + 1)) for i in range(2))))
    assert found.verdict == "match" and not found.physics and not found.described
    assert any("test2 from 12.02 s on" in note for note in found.notes)


def test_channels_that_only_some_have_are_left_out_and_told() -> None:
    one, other = (recorded(duration=2.0, seed=seed) for seed in (0, 1))
    both = together(one, other.without([1]))
    assert both.channels == (Channel("position", "x1"),) and both.measured.shape == (802, 1)
    assert any("velocity of x1 is not in all recordings" in note for note in both.notes)


def test_recordings_of_two_rigs_are_refused() -> None:
    with pytest.raises(InputError, match="not of one rig"):
        one_after_the_other([recorded(duration=2.0), EVIDENCE], ["a", "b"], np.full(1, 0.5))
    other = apply(plant(), {"plant.mass": [2.0]})
    with pytest.raises(InputError, match=r"low and high describe two rigs \(plant\)"):
        check_one_rig([plant(), other], ["low", "high"])
    check_one_rig([plant(), plant(start=0.3)], ["low", "high"])
