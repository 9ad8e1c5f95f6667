"""How exactly the physical side is simulated again, how long a search may, and which samples it may use."""

# Accuracy.

REPLAY_RESOLUTION = 2e-5
"""Share of a signal's standard deviation below which a replay does not claim to be right."""

LONGEST_STEP_RADIANS = 0.2
SHORTEST_STEP_RADIANS = 0.05
DRAFT_STEP_RADIANS = 0.5
"""Longest step of a replay, in radians of a motion of the mechanics: where it soon dies, at least, and in a
draft."""

GATHERED_ERROR_SHARE = 1e-4
"""Share of a motion by which the errors of all its steps may move it."""

STEP_ERROR_DIVISOR = 120.0
"""A step of h radians is wrong by h^5 over this (Runge-Kutta of fourth order)."""

KINK_STEP_S = 2.1e-3
KINK_STEP_RADIANS = 0.014
"""Longest step over a kink of a law that nobody locates: the longer of so many s and of so many radians of
the fastest motion."""

MOST_SUBSTEPS = 50
"""Steps of a replay in one interval of the grid, at most."""

AFFORDED_STEPS = 20_000
"""Steps of a replay up to which they are as short as long motions need: a search repeats it by thousands."""

LONGEST_GRID_INTERVAL_NS, GRID_PERIOD_SHARE = 5_000_000, 1.0 / 200.0
"""Longest interval of the grid: so many ns or, where nothing is faster in itself, such a share of a period of
the recorded motion if that is longer. That is 0.03 rad of it, and a sixth of what a step may be."""

TURN_GRID_RADIANS = 1.5
SHARP_GRID_RADIANS = 0.35
DRAFT_GRID_RADIANS = 4.0
"""Longest interval, in radians of the fastest motor, where a wire has a motion of its own or remembers its
path: between the points of the grid the motor moves along parabolas, which shake the one, and turn the other
where nothing turned it if they overshoot. For a wire that remembers, the second is as good as exact; the
third is enough for a draft."""

# Work.

BUDGET_STEPS = 1.5e8
"""Steps of replays with wires after which the search in a recording of `BUDGET_RECORDING_SAMPLES` winds down;
on a slow host about 40 s of one core."""

LOST_STEPS = 4e7
"""The same from where neither a single kind nor a formula comes near the noise: what is found after that
takes less, and mostly nothing is."""

BUDGET_RECORDING_SAMPLES = 50_000
BUDGET_MOST_RATIO = 4.0
"""Samples of a recording up to which the budget is the same; one with more has more in proportion, so often
more at most."""

WIRELESS_STEP_COST = 0.75
"""What a step of a plant without wires takes, over one with them."""

LINEAR_STEP_COST = 0.03
"""What a step of one of many forces on a linear plant takes, over a step of a replay."""

SECOND_QUESTION_STEPS = 3e7
"""Steps that a second question, which is asked of a few kinds only, may take in any case."""

FITS_AT_ONCE = 4
"""Fits that are begun before the budget is looked at again."""

REPLAY_OVERHEAD_STEPS = 5e3
"""Steps that what a replay needs beside its steps takes as long as."""

INPUTS_KEPT = 3
"""Motors, and grids, of which what comes in is kept for who asks again."""

MOTIONS_KEPT, MOTION_BYTES = 3, 50_000_000
"""Motions that are kept for who asks again, at least, and memory up to which more are: a fit that goes on
begins with what the one before it ended with, after others were fitted."""

# Windows: stretches of a recording, each with a start of its own.

SHORT_WINDOW_PERIODS = 1.0
"""Length of short windows, in periods of the recorded motion."""

SHORTEST_WINDOW_PERIODS = 0.015
"""Length of the shortest windows, in periods of the recorded motion: a wrong model stays near for so long."""

WINDOW_FEWEST_SAMPLES = 60
"""Samples of a window at least, each of which has a state of its own to be estimated."""

DRIFT_DECAY_EXPONENT = 5.0
"""A motion that decays by less than exp of minus this over the recording without swinging back drifts."""

START_HALF_WIDTH = 12
"""Samples on either side from which the state at the start of a window is estimated."""

START_FEWEST_SAMPLES = 4
"""Samples of which a state is estimated at least, also at the ends of a recording."""

START_PERIOD_SHARE = 0.08
"""Share of a period that these samples reach at most: over more of it no motion is a parabola."""

START_PERIODS, START_ROUNDS, START_STEP = (1.0, 4.0, 16.0), 2, 1e-4
"""Periods of the motion from which the state at the start is fitted, one after the other, steps of each fit,
and the part of the motion by which they are differenced."""

START_LEAST_SHARE = 1e-2
"""What a part of the state does to the motion, over what others do, from which the fit moves it."""

START_LEFT_RATIO = 1.2
"""Errors over their noise from sample to sample up to which a spec leaves nothing but noise there."""

# Which samples are readings of a sensor.

STRAY_COMMANDS_SHARE = 0.01
"""Share of the uses of commands that may be stamped wrongly."""

CHANNEL_FEWEST_SHARE = 0.5
"""Share of the samples above which a signal counts as measured."""

JOINT_PAUSE_SAMPLES = 4
JOINT_MOTORS_PAUSE_S = 1.0
"""Pause between two recordings of a rig that are replayed one after the other: sampling intervals at least,
and seconds where motors have to go back to where the tests begin."""

REST_MOST_SHARE = 0.1
"""Share of the samples before the first command above which what motors do until then is not left out."""

ROUNDING_STEP_TO_NOISE = 2.5
"""Step, over the noise, from which readings show the steps of their rounding."""

LATTICE_MOST_VALUES = 0.9
"""Different values over samples above which they lie on no lattice: a sensor that rounds repeats some."""

LATTICE_TOLERANCE = 1e-3
"""Share of a step within which all values must lie on the lattice."""

LATTICE_MOST_DIGITS = 12
LATTICE_LAST_DIGIT_SHARE = 0.05
"""Readings written with fewer decimal digits lie off their lattice by half of the last: allowed where that is
below such a share of a step."""

TAIL_STDS = 3.0
"""Typical sizes from which an error is far off."""

TAIL_LAGS = range(4, 21)
"""Samples after which another error that is far off says that the first was no chance: third differences of
white noise have nothing in common then."""

TAILS_TOGETHER_RATIO = 1.5
"""How often errors that are far off come together, over how often chance has it, from which they are no
noise."""

TAILS_PARTS, TAILS_FEWEST_SAMPLES = 12, 100
"""Parts of a recording in most of which a noise has tails if it has any, and samples in each."""

TAILS_LEAST, TAILS_MOST = 1.1, 1.5
"""Standard deviation of a noise over the typical size of its errors, from which it has tails, and the most
that is taken for them: 1 in normal noise, 1.3 in third differences of Student's with three degrees of
freedom; more is left by the steps of commands."""

NOISE_MEDIAN_TO_RMS = 0.3
NOISE_RMS_TO_MEDIAN = 3.0
"""Noise by the median of the differences, over that by their rms, above which the median is right; where it
is below, few samples hold most of the power, and the noise is at most so many times the median."""

SLOW_SENSOR_MOST_SAMPLES = 50
"""Samples from one reading of a sensor to the next, at most."""

SLOW_SENSOR_REGULAR_SHARE = 0.95
"""Share of the changes that must come at multiples of one interval to be readings of a slower sensor."""

SLOW_SENSOR_MOST_CHANGES = 0.6
"""Share of the samples with a change above which a sensor is not slow: it would repeat every other one."""

INTERPOLATED_SHARE = 0.3
"""Share of the samples on straight lines between others from which a recording was interpolated."""

STRAIGHT_BEND_RATIO = 0.02
"""Second difference, over the larger ones of the recording, below which samples lie on a straight line."""

JUMP_BENDS_SHARE = 0.5
"""Share of the bends that come in pairs to and fro, from which a signal jumps rather than was
interpolated."""

KNOT_INTERVAL_RATIO = 3.0
"""Longest interval between two knots of an interpolated recording over the shortest."""

INTERPOLATED_PARTS = 10
"""Parts of a recording that must all show it: a rig at rest is straight for a while only."""

ROUNDED_BEND_STEPS = 4.0
"""Second difference in steps of the readings below which rounding makes the straight lines."""

READINGS_FEWEST_SAMPLES = 200
"""Samples from which readings can be told from what lies between them."""
