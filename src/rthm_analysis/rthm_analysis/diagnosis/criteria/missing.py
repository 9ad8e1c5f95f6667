"""When a free curve of the missing force is told, and how finely it is drawn."""

CURVE_UNSEEN_SHARE = 0.1
"""Share of the mismatch on unseen data that a curve must explain to be told."""

CURVE_GAIN = 25.0
"""Gain in squared error, in units of the noise, that a curve must bring both cross-validated and on unseen
data: five standard deviations of chance."""

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
SMOOTHED_FEWEST_SAMPLES = 7
"""Length of the parabolas that smooth what a model leaves: share of a period of the motion, and samples that
they have at least."""

RESIDUAL_PARABOLA_SAMPLES = 9
"""Samples of the parabola through which the residual motion is differentiated."""
