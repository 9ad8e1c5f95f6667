"""Faults of whole signals: signs, units, hum, lateness, drift, another rig than that of the spec."""

# Smoothed signals and their spectra, in which relations are looked for.

SMOOTH_POWER_SHARE = 0.98
"""Share of a position's power below the frequency that still passes."""

SMOOTH_LEAST_WIDTH = 2.5
"""Samples; narrower bells are no bells."""

SMOOTH_LEAST_GAP = 3
"""Samples; a straight line over a gap of these, or of a third of the bell's width, is good enough."""

SMOOTH_LARGEST_SHARE = 0.02
"""Share of the recording that the width of the bell does not exceed."""

SMOOTH_REACH_STDS = 4.0
"""Half length of the bell over its width."""

SMOOTH_POINTS_PER_WIDTH = 2.0
"""Points taken from the smoothed signals for each width of the bell."""

SMOOTH_FEWEST_POINTS = 40
"""Points from which anything is concluded."""

SPECTRA_PARTS = 12
"""Parts of a recording that are averaged, half of them between the others."""

SPECTRA_HIGHEST_RADIANS = 0.5
"""Largest angular frequency times step: beyond it, differences of samples are no rates."""

# Relations between signals, from which signs, units and swapped channels are told.

RELATED_CORRELATION = 0.9
"""Correlation, of either sign, from which a relation says anything."""

SOUND_CORRELATION = 0.97
"""Correlation of a relation that holds beyond doubt."""

KINEMATIC_GAIN = (0.8, 1.25)
"""Gain between a velocity and the rate of its position, sensors of another scale included."""

MOTOR_GAIN = (0.5, 2.0)
"""Gain between a motor's position and its commands, limits of the motor included."""

ELASTIC_GAIN = (1.0 / 3.0, 3.0)
"""Gain between the force in a wire and what its stiffness makes of its elongation."""

OWN_FACTOR_VARIANCE_SHARE = 0.02
"""Share of the force's variance that a wire's position must make for its own factor to be told."""

OWN_FACTOR_CORRELATION = 0.95
"""Multiple correlation from which the parts of motor and position in a force are told apart."""

OPEN_VARIANCE_SHARE = 1e-6
"""What a relation leaves open at the least, over the variance."""

SWAP_LOG_GAIN = 1.0
"""By so much a swap must leave less open, as a logarithm, than signs and units."""

EXACT_UNIT_LOG = 0.03
"""Relative distance from a ratio of units up to which a gain is that ratio."""

LARGE_UNIT_LOG = 0.1
"""The same for ratios of a hundred and more, which nothing else makes."""

UNITLESS_GAIN = (0.4, 2.5)
"""Gains that are no matter of units: parameters and sensors may be as far off."""

LOAD_CORRELATION = 0.97
"""Correlation between a known force and what the motion makes of it, from which its sign and unit are
judged."""

LOAD_MOST_UNSURE = 0.3
"""Uncertainty, as a logarithm, up to which a unit's ratio is searched around a gain."""

FARTHEST_MOTION = 20.0
"""Metres beyond which a plant's motion is in another unit, where the start does not tell."""

UNIT_AT_START_SHARE = 0.05
"""Relative distance from the spec's start, over a unit's factor, up to which the start tells the unit."""

FAR_START_RATIO = 10.0
"""Start of a free motion over the spec's, above which that a unit explains it is no chance."""

# Another rig, or another loop, than that of the spec.

OTHER_PERIOD_LOG = 0.04
"""Relative difference of the sampling period: clocks and lost samples make less."""

OTHER_START_SHARE = 0.35
"""Distance of the first sample from the spec's start, over the range of the motion and the start itself."""

OTHER_WIRE_FACTOR = 3.0
"""Factor of a wire's stiffness that hardening and slackness leave somewhere in its motion."""

OTHER_WIRE_PARTS = 12
"""Parts of a recording in which the stiffness of a wire is looked at."""

OTHER_WIRE_LEAST_WEIGHT = 0.05
"""How much the elongation changes in a part, over the liveliest one, from which its stiffness counts."""

OTHER_MASS_FACTOR = 3.0
"""Factor of a mass, which no effect of ours makes."""

OTHER_FREQUENCY_FACTOR_UP = 6.0
"""Factor of the natural frequency upwards: a stop of twenty times the stiffness makes less than five."""

OTHER_FREQUENCY_FACTOR_DOWN = 3.0
"""Factor of the natural frequency downwards."""

OTHER_LINEAR_CORRELATION = 0.99
"""Correlation from which the motion is that of a linear plant, though of another one."""

OSCILLATION_POWER_SHARE = 0.9
"""Share of a free motion's power near one frequency, from which it is an oscillation."""

OSCILLATION_FEWEST_PERIODS = 5
"""Periods in a recording from which a free motion tells its frequency."""

OTHER_LOOP_ENTRIES = 5
"""Delays, periods and computing blocks unlike the spec's from which it is of another test: a slow network
changes the four delays, a wrong entry one or two."""

TELLING_FORCE_RATIO = 0.3
"""Rms of inertia or elastic force, over that of the known force, from which its parameter is told by the
motion."""

FREE_MOTION_FORCE_RATIO = 1e-5
"""Rms of the known force, over what the motion needs, below which it is a free motion."""

# Hum: a line of the mains.

MAINS_HZ = (50.0, 60.0)
"""Frequencies of mains, Hz."""

MAINS_WANDER_HZ = 0.3
"""Hz by which mains and clocks are off."""

HUM_NEIGHBOUR_HZ = 4.0
"""Hz on either side, from which the level beside the line is taken."""

HUM_FEWEST_NEIGHBOURS = 20
"""Frequencies beside the line from which their median says what chance is."""

HUM_POWER_TO_MEDIAN = 40.0
"""Power of the line over the median beside it: by chance once in 1e11 lines."""

HUM_POWER_TO_NEXT = 4.0
"""Power of the line over that of the next beside it: the steps of commands and their aliases make many."""

HUM_MEANS_TAKEN_OFF = 3
"""How often a running mean is taken off: each time a motion ten times slower than the line loses 98 %."""

HUM_SHOWN_SHARE = 0.3
"""Share of a line's amplitude that another channel would have to show, were it a motion."""

HUM_SHOWN_POWER_SHARE = 0.5
"""Share of the power that a line must have, from which it shows in another channel of no known ratio."""

HUM_TO_NATURAL_FREQUENCY = 3.0
"""Mains over the plant's highest natural frequency, from which the plant itself hardly moves so fast."""

HUM_PERIODS_PER_SAMPLE = 0.9
"""Periods of the mains from sample to sample; with more, any slow line may be its alias."""

HUM_FEWEST_PERIODS = 20.0
"""Periods of the mains in a recording."""

HUM_AMPLITUDE_RATIO = 3.0
"""Largest over smallest amplitude in the thirds of a recording."""

HUM_OWN_READINGS_SHARE = 0.7
"""Share of the samples that are readings of their own, below which only these are looked at: what repeats or
interpolates them shows every slow motion again beside each multiple of their rate."""

# Lateness of one signal, by the phase of its spectrum, and clocks that drift apart.

LATENESS_COHERENCE = 0.9
"""Squared coherence of the frequencies that count."""

LATENESS_FEWEST_FREQUENCIES = 8
"""Frequencies from which a delay is told."""

SAMPLED_GAIN_STD = 7e-4
"""Relative error of a gain at one frequency that sampling leaves: more is not asked of any model."""

LONGEST_LATENESS = 0.2
"""Largest delay, s."""

DELAY_GAIN_OVER_LAG = 30.0
"""By so much the weighted squares of a delay must be below those of a lag: one in a million by chance."""

DELAY_LEFT_SHARE = 0.25
"""Share of the weighted squares that a delay may leave."""

DELAY_CHI2 = 3.0
"""Weighted squares for each frequency that a delay may leave: with much more, it is something else."""

DELAY_TO_LAG_MOST = 2.0
"""A delay in the place of a lag that was found is at most so many times as long, or as short."""

LAG_RUNS_IN_CONSTANTS = 5.0
"""Time constants after which a filter has forgotten its beginning."""

NO_LAG_S = 1e-9
"""Seconds; a filter so fast changes nothing."""

LATENESS_STEPS = 3
"""Steps towards the best delay, and the best lag."""

LATENESS_LEAST_SAMPLES = 1.5
"""A shorter delay, in samples, is left to others."""

CLOCK_DRIFT_PARTS = 24
"""Parts of a recording, in each of which the delay of the motor is measured."""

CLOCK_DRIFT_LEAST_SAMPLES = 1.5
"""Samples by which the clocks part over a recording; less is left to others."""

CLOCK_DRIFT_CORRELATION = 0.98
"""Correlation between time and delay: a drift is steady, and no lag or limit of a motor grows with time."""

SINC_REACH, SINC_SHARPNESS = 64, 10.0
"""Samples on either side of which a signal between its samples is made, and the Kaiser window's parameter:
white noise keeps 97 % of its third differences where it is moved by half a sample, of 35 % by straight lines.
"""

UNEVEN_SAMPLES_SHARE = 0.01
"""Spread of the intervals between samples, over their length, up to which these are even."""

# Sensors of the motion that read too much or too little, by each other and the known force.

GAIN_LEAST_CHANGE, GAIN_LARGEST_CHANGE = 2e-3, 0.3
"""Change of a reading by a factor between which it is asked for: smaller ones may be the smoothing, and
larger ones are a unit or another rig."""

GAIN_UNRELATED_SHARE = 0.02
"""Share of the squared change of a factor up to which a velocity may not go with the rate of its position: a
lag, a delay or a bend that changes sizes as much changes phases or shapes by far more."""

GAIN_DECIDED_SHARE = 0.25
"""Share of that change within which the known force has to say which of two signals is right; and up to which
mass and stiffness may be uncertain."""

GAIN_UNSURE_STDS = 3.0
"""Stated standard deviations of mass or stiffness, beside that change, by which the known force may be off
where they are too uncertain to say which."""

GAIN_STRETCHES = 8
"""Stretches of time with a friction and a drag of their own: what begins to rub takes no more than one of
them with it."""
