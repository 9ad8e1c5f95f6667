"""When a fit is as good as it gets, what its standard deviations are worth, and what would have been seen."""

POOR_FIT_CHI2 = 3.0
"""Reduced chi-squared above which a model is far from the noise: sensitivities are then computed anew at
every step of a fit, and nothing is settled by it yet."""

DIVERGED_ERROR = 1e6
"""Error, over the noise or the standard deviation of a signal, of a model that diverges, and at most."""

CROSS_VALIDATION_PARTS = 20
"""Parts of the data that take turns at being left out."""

COLUMN_SAMPLES = 60_000
"""Samples of a recording from twice as many of which only one in some is asked where hundreds of columns are
needed at once: for combinations of kinds, and for free curves."""

FIT_STEPS = 8
"""Steps of a fit, unless it is asked for another number."""

FIT_GAIN = 3e-4
"""Share of the squared error that a step must still bring for a fit to go on, unless it is to finish."""

SETTLED_GAIN = 0.1
"""Gain in squared error, in units of the noise, below which no step is worth another: chance makes more."""

DIFFERENCE_STEP = 1e-3
"""Step of finite differences, in the scale of a parameter."""

FINE_FIT_GAIN = 1e-4
FINE_DIFFERENCE_RATIO = 0.02
"""Share of the squared error that a step must still bring in a fit that finishes, and the factor of its last
finite differences."""

LEAST_DAMPING = 1e-4
"""Damping with which a fit begins (Levenberg-Marquardt), in the scale of the parameters."""

LARGEST_LOG_STEP = 1.2
"""Largest step of a positive parameter, as the logarithm of a factor."""

SINGULAR_EIGENVALUE = 1e-12
"""Eigenvalue of the correlations of the parameters below which rounding decides: nothing is known of it."""

UNDETERMINED_SHARE = 1e-6
"""Share of a parameter in an undetermined combination from which it is undetermined too; less is rounding."""

ZERO_ENTRY_SCALE = 0.02
"""Damping ratio, and share of the stiffness that the motion's inertia stands for, as the scale of an entry of
zero."""

# Wires by their own forces.

WIRE_EFFECT_STDS = 3.0
WIRE_EFFECT_SHARE = 0.3
"""Standard deviations, or share of what is claimed, that must be seen of a wire's effect in its own force."""

WIRE_CLAIM_STDS = 4.0
"""Standard deviations by which what is claimed must exceed all that is left of the force."""

WIRE_BLOCK_LENGTHS = (1, 2, 4, 8, 16, 32, 64, 128)
WIRE_FEWEST_BLOCKS = 50
"""Samples in the blocks that are averaged over, and the fewest blocks."""

WIRE_SMOOTHED_SAMPLES = 7
"""Samples under the parabolas that smooth what is recorded of a wire's ends."""

# Detection limits.

DETECTION_HALVINGS = 4
"""Halvings of the logarithm of a range in which the smallest size that would be seen is looked for."""

COINCIDENT_NS = 10_000
"""Time, ns, from a command's step within which a sample sees the step or not by chance."""

MOST_THREADS = 8
"""Threads that replay side by side, at most."""
