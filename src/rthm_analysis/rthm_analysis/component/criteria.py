"""Every number that decides something about a component, with its reason."""

SETTLING_SHARE = 0.04
"""Part of a recording at its beginning that says nothing: what is remembered there is not known."""

LONGEST_GAP_STEPS = 1.5
"""Distance from the next sample, in steps, beyond which nothing is known."""

FEWEST_SAMPLES = 200
"""Samples below which forces of a component cannot be told from each other."""

MOST_LAW_STEPS = 16
"""Steps between two samples in which the states of a law are advanced, at most."""

SUBSTEP_ERROR = 1e-4
"""Change of a law's force, over its size, with half the step: below it the steps are short enough."""

LAGS_TRIED = 24
"""Lags of an input that are compared before the best is refined: even in the logarithm, from half a step to
`LONGEST_LAG_SHARE` of the recording, and none."""

LONGEST_LAG_SHARE = 0.05
"""Longest lag of an input, as a part of the recording: beyond, it is no lag but another signal."""

GUESSES_REFINED = 2
"""Beginnings of a kind that are refined, best first."""

MOST_LAWS = 3
"""Laws beside spring and damper that one component is given."""

BIC_OF_CHANCE = 10.0
"""Gain of the criterion (BIC) that chance brings among the kinds, and the sizes, that are tried."""

LEAST_GAIN_SHARE = 0.05
"""Part of the squared error beyond the noise that a law must take away: less is not worth a name."""

PLAINER_LOSS_SHARE = 0.02
"""Part of the squared error that a plainer kind may leave more than the kind that may stand for it."""

AT_NOISE_RATIO = 1.3
"""Error on unseen data over the noise of the force, up to which a model explains a component."""

BETTER_RATIO = 0.9
"""Error on unseen data over that of spring and damper alone, below which a model is better than these."""

EVALUATIONS_EACH = 60
"""Evaluations of a fit for each of its parameters, at most."""

FIT_DIFFERENCE = 1e-4
"""Relative step of the differences that give the slopes of a fit."""

NEGATIVE_SHARE = 0.03
"""Part of its largest size by which a passive force may come out negative at some input, from noise."""

MOST_POWER = 2
"""Highest power of an input by which a force is scaled."""
