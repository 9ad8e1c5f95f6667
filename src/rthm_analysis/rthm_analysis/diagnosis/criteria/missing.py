"""When a free curve of the missing force is told, and how finely it is drawn."""

CURVE_UNSEEN_SHARE = 0.1
"""Share of the mismatch on unseen data that a curve must explain to be told."""

CURVE_GAIN = 25.0
"""Gain in squared error, in units of the noise, that a curve must bring both cross-validated and on unseen
data: five standard deviations of chance."""

MASS_CHANGE_SHARE = 0.5
"""Change with time of a mass that is added, over its largest size, below which it is no mass that changes."""

MASS_LEFT_RATIO = 0.5
"""What a force over the acceleration may leave, over what others leave, to be told: a slow motion accelerates
as it is displaced."""

SIMPLER_CURVE_LEFT_RATIO = 4.0
"""Mismatch that a curve over fewer variables may leave, over what the best one leaves."""

SIMPLER_CURVE_GAIN_SHARE = 0.85
"""Share of the best curve's gain with which one over fewer variables is taken instead."""

SYMMETRIC_SHARE = 0.85
"""Share of a curve's square that its odd or even part must hold to be called so."""

DISSIPATED_SHARE = 0.5
"""Share of the work without regard to sign that must go one way, to say that the force takes energy."""

DRAWN_CURVE_SHARE = 0.02
"""Share of the variance of a residual force that its mean over a variable must hold, to be drawn where
nothing is named."""

CURVE_TRIAL_FORCE_RATIO = 1e-3
"""Force of a shape in its trial replay over that of the spring: so small that laws stay straight."""

CURVE_RIDGE = 1e-7
"""Weight of a size of zero, over that of the data, where shapes cannot be told apart."""

CURVE_STIFFNESSES = (0.0, 1e-5, 1e-3, 1e-1)
"""Weights, over the mean one of the data, with which neighbouring sizes of a free curve are held together;
what predicts data left out best is taken."""

CURVE_LEAST_RESPONSE = 1e-14
"""Squared response to a shape over the largest of all, below which the data do not reach it."""

CURVE_BINS = 40
"""Bins, with as many samples each, in which the mean of a force is drawn."""

CURVE_SAMPLES_SHOWN = 600
"""Samples that show a law."""

CURVE_KNOTS = 14
"""Knots of a curve over one variable, each between as many samples."""

PERIODIC_CURVE_KNOTS = 64
"""Knots of a curve over the position that comes back again and again, as a force between teeth or magnets."""

SURFACE_KNOTS = 6
"""Knots of a surface in each of its variables."""

TIME_CURVE_KNOTS = 16
"""Knots of a curve over time, and of a coefficient that changes with it."""

SMOOTHED_PERIOD_SHARE = 0.04
SMOOTHED_FEWEST_SAMPLES, SMOOTHED_LEFT_RATIO = 7, 1.25
"""Length of the parabolas that smooth what a model leaves: the largest share of a period of the motion, the
samples that they have at least, and what longer ones may take away over what these do."""

RESIDUAL_PARABOLA_SAMPLES = 9
"""Samples of the parabola through which the residual motion is differentiated."""

REGRESSION_SAMPLES, REGRESSION_PERIOD_SHARE = 30_000, 0.04
"""Samples of a recording from twice as many of which only one in some is asked for free curves, and part of a
period of the motion that these are apart at most."""

MOST_RESPONSE_BYTES = 300_000_000
"""Memory for responses to free curves that are kept until formulas were looked for."""

RESPONSES_AT_ONCE = 8
"""Forces whose responses are found side by side where the plant is linear."""

TERMS_OF_A_FORMULA = 3
"""Terms of a formula."""

TERM_GAIN_SHARE = 0.03
"""Share of the mismatch that each term of a formula must explain beside those before it."""

TERM_LEFT_RATIO, PLAIN_TERM_LEFT_RATIO = 0.7, 0.92
"""What a further term of a formula may leave in short runs, over what was left before it, and one without
numbers of its own."""

PLAIN_LAWS_TOGETHER, PLAIN_SETS_KEPT = 4, 8
NEARLY_SAME_LAW_CORRELATION = 1.0 - 1e-6
"""Correlation with the force of a kind from which a formula is tried as that kind."""

PLAIN_LAWS_ALIKE, SAME_LAW_CORRELATION, SAME_LEFT_RATIO = 0.9999, 1.0 - 1e-9, 1.03
"""Plain laws that explain a force together, sets of each size that are gone on with, correlations from which
a recording does not tell two laws apart, and from which they are one but for rounding, and what a set may
leave, over what the best one leaves, to do as well."""

SAME_LAW_SAMPLES = 2000
"""Samples of a motion along which two laws are compared: they are one but for rounding, or not."""

LONGER_RUNS_RATIOS = (4.0, 16.0, 64.0)
"""Lengths of the runs, in periods of the motion, in which a formula of short runs is fitted one after the
other."""

BEGINNINGS = 10
"""How often the start of a free run and the values of a formula are estimated by turns, while that gains."""

ENOUGH_GONE_SHARE = 0.95
"""Share of the mismatch on unseen data that a force which acts for a while must explain to end the search."""

FORMULA_SIZE_UNCERTAINTY, BESIDE_FIT_BUDGET = 0.1, 1e8
"""Standard deviation of the size of a term, over that size, while kinds are looked for beside it, and the
work that the fit of both may take: steps of replays."""

PLAIN_LEFT_RATIO, PLAIN_GAIN_SHARE, PLAIN_ALLOWED_SHARE = 2.0, 0.8, 0.01
"""What a term without numbers of its own may leave, over what the best one leaves, share of the gain of that
which it must have, to be taken instead, and share of that gain which it may leave in any case: a motion that
is not quite that of a model costs as much."""

SWINGING_ANGLES = (0.3, 3.2)
"""Largest position from which, and up to which, it may be the angle of a pendulum, rad."""

BESIDE_GAIN_LEFT_SHARE = 0.3
"""Share of what other terms leave that a law of the load may leave that needs another gain of the load beside
it."""

FORMULA_GAIN_SHARE = 0.9
"""Share of what the best free curve explains that a formula must explain to take its place."""

SHAPES_REFINED = 5
"""Forms of a term that are fitted to the recording itself, of all that were compared with the curves."""

REFINING_STEPS = 40
"""Responses that may be computed to find the numbers within a shape."""

FORMULA_FIT_STEPS = 12
FORMULA_FITS, FORMULA_LEFT_RATIO = 6, 0.8
"""Steps of the fit of a formula in free runs, how often they are made, and what each time may leave of what
was left before to go on."""

THRESHOLD_COUNT = 11
"""Places within the range of a variable at which something is supposed to begin or end at first."""

BUMP_PLACES = 25
"""Places over the range of a variable at which a bell is supposed to be at first."""

SHAPE_SCALES = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6)
"""Scales of shapes that are tried at first, over the largest size of their variable."""

SHAPE_POWERS = (0.5, 1.5, 2.5)
"""Powers that are tried at first, beside the whole ones."""

BEYOND_SHARES = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
"""Distances from the range of a position at which poles are tried at first, over the length of the range."""

PITCH_COUNT = 40
"""Pitches of forces that come back with the position that are tried at first, from 25 in the range to half of
one."""

PITCH_BINS, PITCH_BINS_MOST = 4, 2000
PITCH_BIN_SAMPLES = 8
PITCH_RANGE_SHARE = 0.01
"""Even bins of the position in a pitch that is looked for in the residual force, at least, and in the whole
range, at most; samples of each of them, on average; and share of the samples on either side that are left
out, as ends are seldom reached."""

SWING_HIGHEST_RATIO = 4.0
"""Highest frequency of a stiffness or damping that swings, over that of the motion."""

SWING_PERIODS = 2.0
"""Periods of a swing that a recording must hold."""

SWING_PEAKS = 3
"""Frequencies at which a swing is tried, and pitches at which a force is."""

WITHIN_REFINED, WITHIN_STEPS, WITHIN_PLACES, WITHIN_STEP_SHARE = 5, 80, 12, 0.05
"""Terms of a force that acts in an interval alone that are fitted to the recording itself, responses that may
be computed for each, places at which the interval is supposed to begin and to end, and how far it may be off
there, over its length."""

OPEN_ENDED_GAIN_SHARE = 0.97
"""Share of the gain of a term that ends with which the same term without an end is told of the unseen
part."""

UNCONFIRMED_SHARE = 0.8
"""Share of what shows in the unseen part alone that one term must explain to be told as unconfirmed."""

PRODUCT_LEAST_LEFT = 100.0
"""Squared error that a term leaves beside the noise, in units of that, from which a factor of it is looked
for."""

PRODUCT_GAIN_RATIO = 1.03
PRODUCT_GAIN_SHARE_OF_REST = 0.3
"""Gain of a term times a free curve over another variable, over that of the term, or beyond it over what the
term leaves, from which the product is asked for a shape."""

PAIRS_OF_FEW_DOFS = 3
"""Dofs up to which a missing force is looked for between any two; of more, where the spec couples them."""

PRODUCTS_REFINED = 2
"""Shapes of such a product that are fitted to the recording itself."""

FORETOLD_SHARE = 0.75
"""Share of the mismatch that a force must explain, where it was fitted and on unseen data, to be told as what
motion and load foretell: else a force that nobody recorded is likelier."""

TERM_SHARE_ABOVE_NOISE = 0.1
"""The same share where a formula leaves more than the noise: small terms then only imitate what is left."""

INSTANT_SAMPLES = 3.0
INSTANT_TRIALS = 14
INSTANT_MOVES = 5
"""Samples on either side of the instant at which a term begins or ends among which it is looked for, trials,
and how often it is looked for again around what was found."""

LIKELY_CURVES = 5
LIKELY_SAMPLES = 8000
LIKELY_APART_SAMPLES = 2 * RESIDUAL_PARABOLA_SAMPLES
"""Free curves that are asked before the long search, of all that the residual force was compared with,
samples that are compared, and how far they are from where free runs begin: half the longest parabola."""

LOAD_LAW_SHARE = 0.98
"""Share of the mismatch that a curve over the known load must explain for the search for kinds to end."""

MOTOR_CURVE_BINS = 150
SAMPLED_TRAINED = 0.6
"""Even bins of a motor's position in which its mean error is taken; and part of the training samples by which
what is known sample by sample is judged first, on the others."""

SAMPLED_BINS = 200
SAMPLED_SHAPES_REFINED = 12
SAMPLED_FIT_STEPS = 100
SAMPLED_GAIN_PER_NUMBER = 10.0
SAMPLED_GAIN_SHARE_OF_REST = 0.3
SAMPLED_LARGEST_RATIO = 4.0
"""Even bins of what is known sample by sample; shapes that are fitted to them for
each term, of all that were compared, and steps of a fit; what each number must gain, in units of the noise;
share of what is left that a further term must explain; and size of a term over that of the whole above which
terms only cancel each other."""

SHOWN_KIND_STARTS, SHOWN_KIND_STEPS, SHOWN_KIND_TRIALS = 2, 12, 40
SHOWN_KIND_BUDGET = 1e7
"""Beginnings from which each way of a kind that a free curve shows is fitted, steps of these fits before the
best of each way is fitted to its end, instants that are tried around its own, and work that may be done for
it: steps of replays."""

FORMULA_STEPS = 4e7
FORMULA_FIT_BUDGET, COMPOSING_BUDGET = 1e7, 1e8
"""Work that may be done to find a formula, beside that of the search for kinds, to fit one in any case, and
after which no other is fitted: steps of replays."""

TERM_FEWEST_PERIODS = 0.5
"""Periods of the motion that a term of a formula must act."""
