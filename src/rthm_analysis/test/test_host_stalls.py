from __future__ import annotations

import numpy as np

from rthm_analysis.timing import timing_of
from rthm_analysis.timing.host_stalls import host_stalls, stalled_between

from .loops import paper, recording, stalled, without_times_of_sending


def test_spans_begin_where_samples_stalled_and_do_not_overlap():
    spans = host_stalls(stalled(recording(paper()), paper(), 3, 50))
    assert 25 <= len(spans) <= 50
    assert (spans[:, 1] > spans[:, 0]).all()
    assert (spans[1:, 0] > spans[:-1, 1]).all()


def test_a_punctual_machine_and_one_that_tells_nothing_stand_nowhere():
    one = stalled(recording(paper()), paper(), 3, 0)
    assert host_stalls(one).shape == (0, 2)
    held = without_times_of_sending(stalled(recording(paper()), paper(), 3, 50))
    assert host_stalls(held).shape == (0, 2)


def test_what_overlaps_a_span_is_disturbed():
    spans = np.array([[10, 20], [40, 50]])
    begins, ends = np.array([0, 0, 20, 21, 45, 51]), np.array([9, 10, 21, 39, 46, 99])
    assert stalled_between(spans, begins, ends).tolist() == [False, True, True, False, True, False]
    assert not stalled_between(np.empty((0, 2), dtype=np.int64), begins, ends).any()


def test_excess_apart_from_a_machine_that_stood_still_is_what_the_links_do():
    told = timing_of(stalled(recording(paper()), paper(), 4, 100), paper()).as_dict()
    for name in ("tau1", "tau2"):
        link = told["links"][name]
        assert link["excess"]["p99"] > 5e-3
        assert link["excess_undisturbed"]["max"] == 0.0
    assert 50 < told["held_up"]["count"] <= 100
    assert 0.02 < told["held_up"]["longest"] < 0.2
