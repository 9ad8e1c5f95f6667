"""What a kind of physics must bring to be named before others, and which candidates are fitted at all."""

# Which of two models is better: gains in cross-validated squared error, in units of the noise.

GAIN_OF_CHANCE = 16.0
"""Gain of the cross-validated squared error, in units of the noise, that is no chance even for the best of
some hundred candidates: four standard deviations. Kinds that are looked for at many places in the data, as
tones at many frequencies, pay for that look elsewhere beside it."""

GAIN_PER_PARAMETER = 4.0
"""Further gain that every further parameter has to bring: two standard deviations of chance."""

DISTINGUISHING_GAIN = 6.0
"""Difference of cross-validated squared errors by which the recording tells two kinds apart."""

NEAR_NOISE_CHI2 = 1.2
"""Reduced chi-squared below which a model is near the noise, so that what is still missing is small."""

FINISHED_CHI2 = 1.02
"""Reduced chi-squared above which something may be left: the fit of an effect goes on before more is looked
for."""

SUFFICIENT_LEFT_SHARE = 0.05
"""Share of the mismatch that a plain kind may leave in a draft that then tries none of many short steps."""

RELEVANT_SHARE_OF_FIRST = 0.03
"""Share of the first mismatch that an effect must explain where no model reaches the noise."""

RELEVANT_SHARE_OF_REST = 0.05
"""Share of what is left of a mismatch that an effect must explain to be what is missing."""

RELEVANT_MAJOR_SHARE = 0.5
"""Share of what is left of a mismatch from which an effect matters, however little it is of the first."""

TRUSTED_ARITHMETIC = 1e-6
"""Share of a signal's standard deviation that nobody's arithmetic is trusted to resolve."""

ARITHMETIC_CHI2 = 0.1
"""Reduced chi-squared below which what is left is no noise but arithmetic, and none is searched."""

# When a search is over.

SEARCH_MOST_EFFECTS = 3
"""Effects that are added to a model, one in each round, at most."""

GIVEN_UP_LEFT_SHARE = 0.3
"""Share of a mismatch above the noise, left by what was found, from which the search is given up."""

VALUES_LEFT_SHARE = 0.8
"""Share of a mismatch that is left by all other values of mass, damping, stiffness and wire from which no
effects are looked for beside them."""

AHEAD_LEFT_SHARE = 0.01
"""Share of what the best single kind leaves that a formula may leave beside the noise to end the search for
kinds; and that a kind which may imitate others may leave of what the best plain one leaves to come first."""

IMITATOR_GIVEN_UP_CHI2 = 30.0
"""Reduced chi-squared from which kinds that can imitate others, and do not, are given up."""

# Which candidates are worth a fit: gains as if everything were linear.

WORTH_A_FIT_SHARE = 0.15
"""Share of the best candidate's gain that another must promise to be refined."""

PROMISING_SHARE_OF_CHANCE = 0.7
WORTH_A_FIT_SHARE_OF_CHANCE = 0.6
"""Shares of `GAIN_OF_CHANCE` that the best candidate must promise for any to be refined, and each for itself:
a fit finds more than a straight line promises."""

KINDS_FROM_TWO_STARTS = 5
"""Best candidates whose kinds are refined from a second start as well."""

MOST_KINDS_REFINED = 10
"""Most kinds that are refined."""

SLOW_KIND_STARTS = 2
"""Starts from which a kind is refined whose replays take many times as long as others'."""

STILL_PROMISING_SHARE = 0.1
"""Share of `GAIN_OF_CHANCE` that a candidate must have gained in the round before to be screened in the
next."""

MOST_KINDS_RESCREENED = 12
"""Most kinds that are screened once more, with the size that was found."""

LARGEST_SIZE_FACTOR = 50.0
"""A size that is further away from the trial's is tried again from nearer by."""

DRIVE_WORTH_A_FIT = 0.5
"""Share of `GAIN_OF_CHANCE` that an effect in a motor must promise to be fitted."""

# Fits of candidates, in heats: the worse ones are given up early.

HEATS = ((2, 0), (3, 6), (8, 2))
"""Steps of the fits of one heat, and how many candidates get into it."""

HEAT_ERROR_RATIO = 10.0
"""How much further from the noise than the best a candidate may be that is fitted any longer."""

HEAT_ERROR_SHARE_OF_NOISE = 0.1
"""Share of the noise by which any candidate may be beyond it and is still fitted."""

IMITATORS_FITTED = 2
"""Other kinds that can imitate others which are fitted longer where the best one does not reach the noise."""

STARTING_SIZE_SHARES = (1.0, 0.5, 0.25, 0.1)
"""Shares of a candidate's estimated size from which its fit may begin."""

FINISHING_STEPS = 24
FINISHING_GAIN = 1e-5
"""Steps for which the fit of an effect that was chosen goes on, and the share of the squared error that each
must bring."""

# Combinations of several effects.

PAIRED_KINDS = 3
"""Plain kinds for which a companion is looked for where no single kind comes near the noise."""

COMBINED_MOST_EFFECTS = 3
"""Most effects of a combination."""

COMBINATIONS_PLAIN = 2
COMBINATIONS_ANY = 3
"""Combinations of plain kinds that are worth a fit, which is soon done, and others."""

COMBINATION_REACH = 0.3
COMBINATION_REACH_NEAR_NOISE = 0.1
"""Share of the squared error, beside what the present effects leave, up to which a combination may become the
best: what it would leave is counted as if everything were linear, and is less once it is fitted. Near the
noise, of a plain combination that stands for what could imitate it."""

COMBINATIONS_AT_ONCE = 20_000
"""Combinations that are solved at once, for the memory that they take."""

COMBINATION_RIDGE = 1e-9
"""Share by which products of columns with themselves are larger, so that equal columns share a size."""

COMBINATIONS_IN_TURN = 2
"""How often a combination that did better is left for another."""

COMBINATION_FIRST_STEPS = 4
COMBINATION_BEHIND_RATIO = 3.0
"""Steps of a fit after which a combination is given up, if its error above the noise is so many times the one
that is to be beaten."""

STEPS_WITH_ANOTHER_KIND = 8
"""Steps of a fit with another kind in the place of one."""

RIVALS_OF_A_ROUND = 4
"""Kinds of each round that are looked at again."""

STEPS_WITHOUT_KIND = 8
"""Steps of a fit without an effect that may be needless."""

# Wires by their own forces.

BESIDE_WIRE_MOST_EFFECTS = 2
"""Plain kinds that may stand beside the effect of a wire."""

BESIDE_WIRE_STEPS = 8
"""Steps of a fit of two effects that were found apart."""

WIRE_LEFT_SHARE = 0.25
WIRE_RIVAL_ERROR_RATIO = 4.0
"""Share of the squared error of a wire's force that may be left along the recorded motion, and how many times
as much a kind leaves that explains it less well; what is noise counts on neither side."""

WIRE_MOST_ALIKE = 2
"""Kinds at most that may explain a force alike: of more it tells nothing."""

WIRE_SETTLED_SHARE = 0.02
WIRE_NOISE_TO_WHITE = 1.5
"""Share of its squared error that is as good as nothing, and how many times its white part something may be
that is only noise."""

WIRE_ROUGH_RUNS = 6
WIRE_FINE_RUNS = 40
"""Runs along the recorded motion for a first fit of every kind, and for the fit of the best."""

WIRE_STD_FACTOR = 3.0
"""Factor on a standard deviation for the noise of the recorded motion, which is not in it."""

# Delays of motors.

DRIVE_LONGEST_DELAY = 0.1
"""Seconds; a longer delay of a motor is not looked for."""

DRIVE_SHORTEST_DELAY = 2e-4
"""Seconds; where not even this much makes it better, no delay is looked for."""

DRIVE_FLAT_DELAY = 2e-3
"""Seconds; between two samples no delay is looked for any further away."""

COMMAND_BINS = 1 << 17
"""Bins of the commanded range in which an error that comes again with the command is looked for."""

ROUNDING_FEWEST_STEPS = 6
ROUNDING_LINE_TO_RMS = 6.0
"""Steps of rounding within the range of the commands, and line in the spectrum over its rms, from which
commands are rounded."""

# Tones: loads and errors of one frequency.

TONE_PADDING = 4
"""Length of the spectrum in which tones are looked for, over that of the recording."""

TONE_HIGHEST_TO_MOTION = 10.0
"""Highest tone over the frequency of the recorded motion, where that is fast."""

TONE_HIGHEST = 400.0
"""rad/s; faster tones are not looked for."""

TONE_PARTS = 5
"""Parts of the training data that have to agree on a tone; each has some periods of all but the slowest."""

TONE_AGREEMENT_STDS = 3.0
TONE_AGREEMENT = 0.5
TONE_AGREEMENT_AT_RIG = 0.25
"""Standard deviations, and relative change of size, or of phase in rad, beside them, by which a part may
differ; for a tone at a frequency of its own, and for one at a frequency of the rig or beside another tone."""

TONE_RIVAL_SHARE = 0.5
TONE_RIVAL_SHARE_AT_RIG = 0.25
"""Share of a tone's gain from which another kind is named before it, in the same two cases: the tone, if
there is one, is found beside that kind."""

TONE_RESOLUTION = 2.0
LOAD_LINE_SHARE = 0.3
"""Distance of two frequencies that a recording hardly tells apart, in 2 pi over its duration; share of the
largest line of a load from which another counts."""

RINGING_SHARE = 0.05
"""Share of a natural frequency of the rig within which a tone may be its free motion."""

PEAK_WIDTH = 2.0
"""Width over which a spectrum is averaged before its peaks are taken, rad/s."""

PEAK_STDS = 6.0
"""Standard deviations by which a peak must rise above the noise of a spectrum."""
