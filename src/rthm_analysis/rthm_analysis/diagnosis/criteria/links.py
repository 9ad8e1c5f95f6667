"""Delays, losses, stalls and clocks of the links."""

# Which kind a link has: gains are differences of log-likelihoods.

LINK_KIND_GAIN = 8.0
"""Gain in the logarithm of the likelihood, on uses not fitted to, that a kind must bring."""

LINK_TELLING_GAIN = 3.0
"""Gain in the logarithm of the likelihood with which two explanations are told from each other."""

LATENESS_GAIN = 4.0
"""Gain in the logarithm of the likelihood with which lateness beside a kind is taken for real."""

STRAY_COST_PER_SAMPLE = 0.0031
"""What allowing for strays costs per sample in the logarithm of the likelihood."""

LINK_DETECTION_GAIN = 15.0
"""Expected gain in the logarithm of the likelihood at which an effect is as good as always found."""

LINK_DETECTION_RANGES = {"delay": (1e-6, 1.0), "spread": (1e-6, 1.0), "lost": (1e-5, 1.0)}
"""Sizes, s and 1, between which the smallest is looked for that would have been told."""

LINK_FLOOR = 1e-5
"""Error in the age of a sample that clocks and rounding leave, s."""

BUSY_RATIO = 3.0
"""A delay or jitter must be so many times what the machine does to the other links."""

PUNCTUAL_LATE_SHARE = 0.01
"""Share of the ticks up to which a punctual machine may be late."""

# How uses and samples are fitted.

USE_GRAIN = 1e-6
"""Instants of use are taken as exact to this, s."""

USE_TOLD_NS = 1_000_000
"""A receiver tells a use, ns, at most so much after the command that it made of it, unless it stalls."""

LINK_FEWEST_USES = 20
"""Uses of a link below which it is not checked."""

AS_DRAWN_SHARE = 0.98
"""Share of the samples that must come when the random numbers of the spec say, to be drawn from them."""

AS_COMMANDED_SHARE = 0.5
"""Share of the commands that must repeat the force reference as it was used, to tell when it was."""

LINK_BLOCKS = 10
"""Blocks of time; odd ones judge what even ones fitted, and the other way round."""

LINK_BOUNDS = {
    "delay": (-60.0, 60.0),
    "spread": (1e-6, 1.0),
    "mean": (2e-6, 7e-4),
    "lost": (1e-5, 0.999),
    "share": (1e-5, 1.0 - 1e-9),
}
"""Within which parameters are searched, s and 1; longer lateness is a stray."""

FINE_GRAIN_NS = 1_000
"""Intervals are counted as finely, ns, where few are different, as where clocks tick exactly."""

MOST_DIFFERENT_INTERVALS = 3000
"""With more different intervals than this, steps are ten times as long: a search asks each of them."""

EARLY_TELLS_NS = 20_000_000
"""A sample that is never used and passed over only longer, ns, before its time than this tells nothing."""

STRAY_SHARE = 0.003
"""Share of samples that may be late by any time."""

STRAY_LATE = 0.02
STRAY_EARLY = 0.001
"""Means of the times by which strays come late and early, s."""

LOOKS_PER_PERIOD = 8
"""How often per period of the samples the age is looked at where the receiver has no clock."""

DEEPEST_HELD_SAMPLES = 60
"""Samples, from the newest on, that a receiver may hold."""

# Periods of clocks.

OTHER_PERIOD_SHARE = 1e-3
"""Share by which a period must be off to be another one; clocks that drift differ by far less."""

PERIOD_FEWEST_STAMPS = 50
"""Stamps below which a period is not measured."""

WHOLE_PERIODS_SHARE = 0.9
WHOLE_PERIOD_TOLERANCE = 0.25
"""Share of the steps that must be whole periods, and to which part of a period."""

ON_TICK_PERIOD_SHARE = 0.05
"""Part of a period within which a command belongs to a tick."""

COMMANDS_PER_REFERENCE = 1.05
"""Commands beside the ticks of a period, over the references that may each have made one, up to which
references account for them."""

FOUND_TICKS_COMMANDED = 0.95
SPEC_TICKS_COMMANDED = 0.7
"""Share of the ticks with a command that a period needs to be found, and to be kept as the spec's."""

# Stalls and outages.

OUTAGE_PERIODS = 10
"""Periods of sender and receiver, whichever is longer, for which nothing comes in an outage."""

OUTAGE_TO_USUAL = 4.0
"""Samples that an outage takes, over those that all but one use in a hundred pass over: jitter does that."""

OUTAGE_LOOKED_SHARE = 0.5
"""Share of its ticks at which the receiver must have looked meanwhile: else it stalled itself."""

STALL_MISSING_SAMPLES = 3
"""Samples that are missing at one tick in a stall."""

STALL_RATIO_TO_CHANCE = 3.0
"""So many times more ticks without as many samples as chance has them are stalls."""

STALL_MOST_SHARE = 0.06
"""Largest share of the uses that may be stalls; what is more frequent is how the link is."""

STALL_LATE = 0.001
"""A sample that overtook others and was itself this late, s, came after a stall."""

# Stamps that are shifted.

SHIFT_USES = 300
"""Uses from which a shift of stamps is found."""

SHIFT_VOTES_SHARE = 0.5
SHIFT_VOTES_TO_BEST = 0.9
"""Share of the uses whose stamps must be stamps of the source with a shift, and their number over that of the
best shift."""

SHIFT_FEWEST_VALUES = 20
"""Values below which no misfit tells a shift."""

SHIFT_REACHES_NS = (100_000_000, 5_000_000_000)
"""Largest shifts that are tried, ns, one after the other."""

FORESEEN_SHARE = 0.1
"""Share of uses before their sample was taken that bad stamps explain."""

EQUAL_VALUES_RATIO = 1e-9
"""Values that fit this well, relative to the signal's rms, are those of the right samples."""

SAMPLE_MISFIT_RATIO = 1e-2
COMMAND_MISFIT_RATIO = 0.9
"""Values that fit the right sample, and motors that follow the right command, leave less than this share of
the misfit of the nearest stamps; motors have noise and lags."""
