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

WANDER_KNOT_PERIODS = 1.0
"""Periods of the motion between the knots of a curve over time that follows no motion."""

WANDER_SHARE = 0.8
"""Share of an error beyond the noise that such a curve explains where the zero of its sensor wanders: of a
random walk all but some hundredths; of an error that goes with the motion next to nothing."""

WANDER_ROUNDS = 2
"""Times that uncertain values are fitted beside such a curve and the curve beside them: slow and fast parts
of a signal hardly touch each other."""

WANDER_STEADY_SHARE = 0.2
"""Range of an error over its largest size up to which it is said to be off, and not to wander."""

WANDER_LEAST_RESPONSE = 1e-3
"""Squared response of a position to a force, over the largest of all, below which the force is not told from
the position: next to an antiresonance any noise would be a large force."""

LOUD_RATIO = 3.0
"""Noise over that of the spec from which it is told: several times more than any estimate is off."""

DRIFTING_ROUNDS, DRIFTING_DONE_SAMPLES = 20, 1e-3
"""Steps of Gauss and Newton to the delay, at most, and the change of the delay in samples after which they
end: a force that is moved drives the rig otherwise, so that each step leaves some two fifths."""

DRIFTING_TRIALS = 3
"""Steps behind which half the share is asked for: values that made up for a drift move with it at first."""

VALUE_STEP = 1e-4
"""Step, over its scale, in which what a value makes of a prediction is asked."""

DRIFTING_SHARE = 0.9
"""Share of what a model leaves that a delay which grows steadily explains, in fitted and in unseen data."""

DEVIATION_STEP, DEVIATION_ROUNDS, DEVIATION_DONE_SHARE = 1e-3, 12, 1e-3
"""Of what a whole recording deviates by: the part by which its numbers are differenced; steps of Gauss and
Newton to them, at most, and the part by which the last one may move them."""

DEVIATION_TRIALS, DEVIATION_LEFT_SHARE = 4, 0.5
"""Steps behind which it must leave less than such a share of the error, or is given up."""

FORCE_LAG_BEGIN_PERIODS = 0.02
"""Time constant of the lag of a known force from which it is looked for, in periods of the motion."""

LEAK_TOLD_SHARE = 0.05
"""Part of the largest share of a force or reading at another dof from which on another share is told."""

PUSH_RUN_LENGTHS = (2.0, 3.0)
"""Lengths of runs, over the shortest, in which a push is looked for: one at the end of a run hardly shows."""

PUSH_NARROW_LENGTH = 0.5
"""The same of runs that tell when it happened, once the model is known."""

PUSH_FEWEST_RUNS = 8
"""Runs that it takes to say that only one is off."""

PUSH_MOST_SHARE = 0.3
"""Share of the runs that may be off."""

PUSH_LONGEST_PERIODS = 2.5
"""Periods of the motion that a push may last: what acts longer may be physics of an interval."""

PUSH_RATIO = 2.5
"""Reduced chi-squared of a run over that of most runs from which it is off whatever the values of the model:
they take up some of a push."""

PUSH_REST_CHI2, PUSH_LEFT_RATIO = 5.0, 5.0
"""Reduced chi-squared up to which the other runs may be off, as under loads that are not quite known between
samples, unless all are alike; and the ratio of the most that is left to the worst of them from which
something pushed the plant."""

PUSH_APART_RATIO = 100.0
"""The same ratio, of the least, from which something pushed it whatever else the others leave."""

PUSH_GOES_ON_RATIO = 2.0
"""The same ratio up to which the motion behind a moment is that before it."""

PUSH_ROUNDS = 3
"""Steps of Gauss and Newton to the values of the model behind a push."""

PUSH_SEARCHES = 3
"""Times that pushes are looked for: of two in neighbouring runs the smaller one shows behind the other."""

PUSH_FEWEST_SAMPLES_BEHIND = 100
"""Samples that a motion which begins anew behind a push must have to say anything."""
