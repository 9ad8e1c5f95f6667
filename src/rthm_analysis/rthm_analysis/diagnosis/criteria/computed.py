"""Numerical side, controller and compensators, computed again from what was recorded."""

COMPUTED_FLOOR = 1e-3
"""Noise floor of a block that computes, over the rms of its output (contract, section 7)."""

COMPUTED_FEWEST_SAMPLES = 30
"""Ticks or commands below which nothing is said of a block that computes."""

RIGHT_COMMAND_RMS_SHARE = 1e-6
"""Error of a command over the rms of u_d up to which it is right: what rounding to single precision would
leave."""

RIGHT_COMMANDS_SHARE = 0.9
"""Share of the commands that a law must get right; limits of a safety monitor may act in the others."""

ROUGHLY_RIGHT_RATIO = 10.0
"""Error of a command, over that of a right one, within which it counts for a compliance known roughly."""

LIMITED_COMMANDS_SHARE = 1e-3
"""Share of wrong commands, beside a law that gets the others right, from which limits are told."""

OTHER_LAW_LEFT_SHARE = 0.1
"""Share of the error that another law of x1 and F_d may leave, fitted and unseen, to be told."""

STATE_ROUNDING = 3e-6
"""Error of one step, over the size of the step, that needs no explanation."""

SIGNIFICANT_TO_ROUNDING = 10.0
"""Error of one step, over what needs no explanation, above which something is left to be explained."""

NUMERICAL_STILL_LEFT_SHARE = 0.05
"""Share of the first error that parameters may leave before more is said to be left."""

NUMERICAL_LEFT_SHARE = 0.3
"""Share of the error, on ticks that it was not fitted to, that a parameter may leave and be named."""

NUMERICAL_MOST_PARAMETERS = 3
"""Parameters of the numerical side that are looked for at once, at most."""

MOVED_PARAMETER_STDS = 5.0
MOVED_PARAMETER_SHARE = 1e-4
"""Standard deviations, and share of its value, by both of which a parameter of the numerical side must move
to be one that is wrong, where all are fitted at once."""

COMPENSATOR_COMMANDS_TRIED = 600
"""Commands on which compensators are tried before one is tried on all."""

COMPENSATOR_LONGEST_HORIZON = 0.2
"""Longest time ahead, s, for which a prediction is looked for."""

COMPENSATOR_FEWEST_ROWS = 20
"""Force references from which a horizon is fitted."""

COMPENSATOR_OUTLIER_MEDIANS = 3.0
"""Misfit over its median beyond which a force reference does not count for the horizon."""
