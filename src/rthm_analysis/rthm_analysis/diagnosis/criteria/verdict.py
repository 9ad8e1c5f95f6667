"""When the names that were found explain a recording: errors on unseen data, and what is left."""

TRAINED_SHARE = 2.0 / 3.0
"""Share of a recording, from its start, that fits and choices may see: the rest confirms what they chose."""

# At the noise.

NOISE_FLOOR_RATIO = 1.3
"""Rms error on unseen data, over the noise, up to which a model is at the noise (contract)."""

STILL_SIGNAL_TO_NOISE = 3.0
"""Standard deviation of a signal on unseen data, over its noise, below which it stands still there: the whole
recording then says how large it is."""

TRAINING_SLOW_POWER = 4.0
"""Power of the slow residual of a fitted model, over that of noise, that its values may leave in training."""

LEFT_SHARE_OF_SLOW_POWER = 0.15
MOST_LEFT_SLOW_POWER = 100.0
"""Share of the nominal model's slow residual that names may leave in training, and the most that it may be,
in units of the noise."""

ARITHMETIC_SHARE_OF_SLOW_POWER = 1e-5
"""Share of the retuned model's slow residual that the arithmetic of a replay may leave."""

PREDICTION_SPREAD = 1.0
"""What the uncertainty of the values makes of a prediction of unseen data, over the noise, above which one
free run tells nothing there: after so many contacts the right model, too, is somewhere else."""

# Whether names are earned.

MISMATCH_SHARE_OF_ERROR = 0.1
"""Share of a squared error above which it is mismatch, and no noise that was taken for too small."""

MAJOR_EXPLAINED_SHARE = 0.5
"""Share of a mismatch that names must remove where the model reaches the noise."""

IMITATOR_EXPLAINED_SHARE = 0.999
"""Share of the mismatch that kinds must remove to be named if they can imitate others."""

MEMORY_EXPLAINED_SHARE, MEMORY_LEFT_RATIO = 0.97, 0.1
"""Share of the mismatch that one kind which may imitate others must remove to be named where it leaves so
small a part of what any force of motion, load and time would: then it has a memory as the rig has."""

WORSE_ERROR_RATIO = 1.2
"""Error of a signal on unseen data with names, over that without, from which they are no explanation."""

NO_BETTER_THAN_STILL = 0.95
"""Error of a signal on unseen data, over its standard deviation, from which a model that does not move at all
would be as good."""

CONFIRMING_GAIN = 4.0
"""Squared error on unseen data, in units of the noise, that an effect must remove: two standard deviations of
chance for one parameter, or four where the noise has a colour, which is known only about."""

CONTACT_EXPLAINED_SHARE = 0.95
"""Share of what was left that a contact must remove where it may only patch the curve of a spring: a real one
removes nearly everything."""

NEGLIGIBLE_SHARE = 0.01
"""Share of the mismatch on unseen data below which an effect does not matter."""

SLIGHT_SHARE = 0.02
SLIGHT_STD_SHARE = 0.05
"""Share of the squared error on unseen data below which an effect is slight, and the part of its values up to
which their standard deviations may then go: what is known no better may be the imperfection of the others."""

RETUNED_LEFT_SHARE = 0.5
"""Share of the mismatch on unseen data that new values may leave, to be told although they do not reach the
noise."""

RIVAL_GAIN_SHARE = 0.9
"""Share of an effect's gain that another kind may bring, too: with more, both only mend a shape."""

# Names above the noise: smooth laws that remove nearly everything.

SMOOTH_LAW_EXPLAINED_SHARE = 0.98
"""Share of the mismatch that smooth laws together must remove on unseen data to be named above the noise."""

CURVE_SHARE_OF_REST = 0.5
"""Share of what is left that a free curve over any of a law's variables may explain: with more, the law has
another shape."""

CONSTANT_PART_SHARE = 1.0 / 3.0
"""Size of a force over the position that no kind states, over that of a constant force beside it, from which
the constant may be part of it."""

NEEDED_SHARE_OF_MISMATCH = 0.03
NEEDED_RATIO_TO_REST = 5.0
"""Share of the mismatch that each law must be needed for, or how many times what is left: a small one only
imitates that."""

FRICTION_EXPLAINED_SHARE = 0.75
FRICTION_EXPLAINED_SHARE_BESIDE_LOAD = 0.9
"""Share of the mismatch that dry friction must remove, by itself and beside a constant force."""

FRICTION_JUMP_SHARE = 0.5
FRICTION_JUMP_STDS = 4.0
"""Share of a named friction by which a free curve may change its jump at rest, and standard deviations by
which that jump must be above zero."""

# Noise taken for motion, and motion taken for noise.

WINDOWED_CHI2 = 10.0
"""Reduced chi-squared from which longer runs would only drift further."""

LONGEST_RUN_SHARE = 0.08
"""Share of a recording above which runs are made no longer to tell the noise."""

OTHER_BEGINNING_EXPLAINED_SHARE = 0.5
"""Share of what is left that another way of the loads must remove: far from the noise, the smaller of two
errors says nothing."""

REFIT_CHI2 = 1.5
"""Reduced chi-squared of a model above which one that was fitted from it is fitted again."""

NOISE_REVISED_RATIO = 0.7
"""Noise of a channel once more is known, over that before, below which motion had been taken for noise."""

LOST_CHI2 = 5.0
"""Reduced chi-squared of the best single effect in a run over everything, from which effects are looked for
in short runs."""

# Motors and wires by what they measure themselves.

WIRE_SLOW_POWER = 3.0
"""Power of the slow residual of a wire's force along the recorded motion, over the noise, from which the wire
is where something is missing: what the smoothing of that motion leaves is less."""

MOTOR_SENSOR_OFF_RATIO = 10.0
"""Error of a motor's position over the noise of its sensor, from which it is no mismatch of timing."""

MOTOR_EXPLAINED_SHARE = 0.5
"""Share of that residual above which the measured error of the motor is the reason."""

NEGLIGIBLE_DELAY_STD = 1e-6
"""Standard deviation of a motor's delay, s, below which it makes no difference: no search is finer."""

# Times and values that are told.

LARGEST_INTERVAL_SHARE = 0.8
"""Share of a recording over which a mismatch that starts or stops may reach and still have an interval."""

LATE_TRAINING_SHARE = 0.9
"""Share of the training part before which nothing may show, to say that it shows only in unseen data."""

SAME_VALUE_SHARE = 2e-4
"""Relative difference up to which a value is still that of the spec: clocks that are off by 1e-4 make
stiffness or mass look so much off."""

ROUNDING_STEP_RATIO = 0.8
"""Step of a sensor, over what the best model leaves unexplained, from which rounding is worth a word."""

ROUNDING_ERROR_STEPS = 0.6
ROUNDING_BEYOND_SHARE = 0.01
"""Size of an error, in steps of a sensor, that rounding makes, and the share of samples that noise may take
further: where the motion is small, all readings are off the same way."""

FEWEST_RECORDED_SAMPLES = 100
"""Samples of a recording below which nothing is concluded: each part of a cross-validation needs some."""

PATCHED_ERROR_RATIO = 1.05
"""Error of a free run of the patched spec, over that of the nominal one, with which it is still written."""

RUNAWAY_ERROR_RATIO = 1000.0
"""Error of a free run, over the standard deviation of the signal, beyond which it has run away."""

ASTRAY_ERROR_RATIO = 5.0
"""Error of a model on unseen data, over the standard deviation of the signal, from which what it leaves is of
a motion that was never there, and describes nothing."""

# Work: steps of the fits that answer the questions above.

STEPS_WITHOUT_EFFECT = 6
STEPS_WITHOUT_VALUE = 6
STEPS_OF_ANOTHER_BEGINNING = 4
"""Steps of a fit without one of the effects, with a value returned to that of the spec, and of one that shows
whether another way fits."""

DRIVE_MOST_EFFECTS = 2
"""Most effects that are added to the motors, one in each round."""

DRIVE_STEPS = 12
"""Steps of the fit of an effect in a motor."""

DRAFT_FEWEST_SAMPLES = 3000
DRAFT_LEAST_EXCESS = 5000.0
"""Samples that a draft has at least, and squared error in them above the noise, in units of the noise: so
much tells kinds apart."""

DRAFT_MOST_APART = 16
"""Samples from one of a draft to the next at most: further apart, in a long recording that is sampled often,
the recorded motion is not smooth enough for the force of a wire to follow from it."""

DRAFT_FEWEST_IN_WINDOW = 30
"""Samples of a draft in each window at least."""

DRAFT_KINDS_COPIED = 5
"""Kinds of each round of a draft that are copied near the noise: the one that was chosen and others."""

ACTING_RUN_RATIOS = (1.0, 4.0, 16.0)
ACTING_STDS = 6.0
ACTING_FEWEST_QUIET = 3
"""Lengths in periods of the motion of the runs that tell when a force acts, standard deviations of the
squared error of noise from which a run leaves more than that, and how many must leave no more."""
