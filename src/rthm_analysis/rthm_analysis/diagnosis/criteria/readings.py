"""Sensors that are not linear, and noise that is not what the spec says."""

BENT_SHARE = 0.8
"""Share of what a model leaves of a signal that a curve over the reading explains, both in the data it was
fitted to and in unseen ones: of what a force leaves 0.5 at most, as the dynamics of the rig smear it; of what
a sensor does 0.93 and more."""

BENT_PART_SAMPLES = 20
"""Samples in each part of the range of a sensor, on average; their means say whether there may be a curve."""

BENT_SHARE_LOST = 0.2
"""Share that such means may miss of a curve that repeats often."""

BENT_DEGREE = 7
BENT_DEGREE_BESIDE = 3
"""Degree of the curve: the inverse of a bend of a tenth of the range has to be told to the noise; beside what
repeats, of which a higher one would take some for its own."""

BENT_ROUNDS = 30
"""Times that a true value is put into the error of its reading, which grows slower than the value."""

BENT_FEWEST_SAMPLES = 400
"""Samples that a curve takes."""

BENT_PERIODS = (2.0, 40.0)
"""Times that an error which repeats along the range of a sensor does so."""

BENT_TRIALS = 400
"""Periods that are tried."""

BENT_GAIN = 0.5
BENT_REPEATING_SHARE = 1e-3
"""Share of what a smooth curve leaves, and of all, that an error which repeats explains where it is told."""

LOUD_RATIO = 3.0
"""Noise over that of the spec from which it is told: several times more than any estimate is off."""

DRIFTING_ROUNDS, DRIFTING_DONE_SAMPLES = 20, 1e-3
"""Steps of Gauss and Newton to the delay, at most, and the change of the delay in samples after which they
end: a force that is moved drives the rig otherwise, so that each step leaves some two fifths."""

DRIFTING_SHARE = 0.9
"""Share of what a model leaves that a delay which grows steadily explains, in fitted and in unseen data."""
