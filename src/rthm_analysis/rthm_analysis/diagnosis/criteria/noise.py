"""What is noise, with or without a colour, and what is left beyond it."""

# Spectra: a colour is a second part of the noise, with a memory.

SPECTRUM_FEWEST_SAMPLES = 200
"""Samples from which a spectrum says anything."""

SPECTRUM_BANDS = 40
"""Bands of the spectrum, evenly spaced in the logarithm of the frequency."""

SPECTRUM_STEPS = 150
"""Steps in which the likeliest sizes of the parts of a spectrum are found."""

SPECTRUM_LEAST_POWER = 1e-6
"""Share of a band's power below which no fitted spectrum is taken: its logarithm stays a number."""

MOTION_POWER_RATIO = 4.0
"""Power of the recording over that of the residual from which a band shows the rig's motion."""

COLOUR_SHARE_OF_SIGNAL = 0.05
COLOUR_RATIO_TO_WHITE = 1.5
"""Standard deviation of the coloured part, over those of the recording and of the white part, above both of
which it is not noise."""

BAND_POWER_STD = 0.03
"""Relative error of a band's power that is not chance, as from a slightly wrong shape."""

COLOUR_LIKELIHOOD_GAIN = 20.0
"""Gain of twice the log-likelihood by a coloured part that is beyond chance for two parameters."""

COLOUR_MISFIT_PER_BAND = 2.5
"""Misfit per band, twice the log-likelihood, that noise of two parts may have: a line has more."""

COLOUR_LIKELIHOOD_LOSS = 6.0
"""Loss of twice the log-likelihood with which a longer memory is taken: what may be noise is no physics."""

COLOUR_LEAST_SHARE_OF_WHITE = 0.05
"""Share of the white noise that the coloured part must add in some band, to matter."""

# Errors of a sensor or motion: whether anything foretells them.

FORETELLING_SHIFTS = (-2, -1, 0, 1, 2)
"""Samples by which a predicted force is shifted: with all of them goes what a wrong wire or motor leaves."""

OWN_VALUE_LEVELS = 16
OWN_VALUE_STRETCHES = 8
"""Steps of a curve over a signal's own value, and stretches of time that foretell each other by it."""

OWN_VALUE_SHARE = 0.3
"""Share of an error's variance, foretold by the signal's own value in other stretches, from which it is no
noise."""

COHERENT_FREQUENCIES = 8
COHERENCE_CHANCE = 1e-6
"""Frequencies, and the chance that independent errors are as coherent at them: below it they are motion."""

COLOUR_FEWEST_READINGS_SHARE = 0.9
"""Share of the samples that must be readings, for their neighbours to tell a colour."""

CAUSE_SHIFTS = (-8, -4, -2, -1, 0, 1, 2, 4, 8, 16)
"""Samples by which causes are shifted: together they foretell what a lag or another delay leaves."""

CAUSE_LEVELS = 12
"""Steps of a curve over a cause, and over its change: what a limit, a gap or friction leaves."""

CAUSE_STRETCHES = 8
"""Stretches of time that foretell each other."""

CAUSE_SHARE = 0.1
"""Share of an error's variance that causes foretell in other stretches, from which it is no noise."""

CAUSE_LEAST_EIGENVALUE = 1e-13
"""Share of the largest eigenvalue of the normal equations below which the others are rounding."""

EVENT_POWER_RATIO = 6.0
"""Power of the loudest stretch over that of the middle one, from which something happened there."""

DRIFT_LEFT_SHARE = 0.5
"""Share of an error's variance that a line over time leaves, below which its sensor drifts."""

RARE_MEDIAN_SHARE = 0.01
"""Median square of an error over its mean square, below which a few samples hold all of it: 0.45 in noise,
0.2 where its tails are heavy."""

# A channel that would show an error of another one.

DENYING_POWER_RATIO = 4.0
"""Power that errors would have in the other channel, over that of its noise, from which it can deny them."""

DENIED_SHARE = 0.5
DENIED_STDS = 3.0
"""Share of what errors would make of the other channel that it shows at most where it denies them, of either
sign, since a force moves the plant and motion makes a force; standard deviations by which that must be
sure."""

INDEPENDENT_SHARE = 0.1
"""Share of the averages of an error that count as independent of each other."""

# What is left: averages in which noise drowns and physics does not.

SLOW_SAMPLES = 16
"""Samples in an average in which noise drowns and physics does not."""

SLOW_POWER_WHITE = 1.35
"""Power of the slow residual, over that of noise, above which something is left: 0.15 of the noise, which the
arithmetic of a replay may leave."""

SLOW_POWER_COLOURED = 3.0
"""The same where the noise has a colour, which a recording tells only about."""

SLOW_POWER_STDS = 8.0
SLOW_POWER_CHANCE = 1e-7
"""Standard deviations of a part's power that no clean recording reaches in any of its parts; of few averages,
whose power is far from normal, the chance that is small enough for that."""

FEWEST_NORMAL_AVERAGES = 23
"""Averages from which the quantile of `SLOW_POWER_CHANCE` is within `SLOW_POWER_STDS`."""

COLOURED_STD_RATIO = 2.0
"""How much larger chance is where the noise has a colour: its estimate leaves some of it."""

EVENT_PARTS = 30
"""Parts of a recording that are looked at one by one for when something happens."""

OTHER_WAY_CHI2_RATIO = 3.0
"""Chi-squared over the least of all ways in which a load may be between its samples, beyond which a way is
not that of the rig."""

UNTOUCHED_SHARE = 0.05
"""Share of a channel's squared error up to which effects took nothing out of it that its noise was."""

OUTLIER_STDS = 6.0
"""Robust standard deviations beyond which a difference is a jump, not noise."""

OUTLIER_SHARE = 0.02
"""Share of a noise that may be beyond that: of Student's with three degrees of freedom it is 0.007."""

# Noise of a motor's position.

DRIVE_COLOUR_RATIO_TO_WHITE = 2.0
DRIVE_COLOUR_SHARE_OF_SIGNAL = 0.01
"""Size of an error over that of white noise from which it may be noise with a colour; over that of the
motion, up to which it may."""

# Accelerometers.

OFFSET_TOLD_STDS = 5.0
"""Standard deviations from which an offset is told that was taken out."""

FILTERED_RMS_RATIO = 1.15
"""Size of what is left of noise once its filter is undone, over that of its fastest part, up to which it is
white.
"""
