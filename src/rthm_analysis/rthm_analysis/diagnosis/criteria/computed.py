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

STATE_ROUNDING = 3e-6
"""Error of one step, over the size of the step, that needs no explanation."""

NUMERICAL_LEFT_SHARE = 0.3
"""Share of the error, on ticks that it was not fitted to, that a parameter may leave and be named."""

NUMERICAL_MOST_PARAMETERS = 3
"""Parameters of the numerical side that are looked for at once, at most."""

COMPENSATOR_COMMANDS_TRIED = 600
"""Commands on which compensators are tried before one is tried on all."""

COMPENSATOR_LONGEST_HORIZON = 0.2
"""Longest time ahead, s, for which a prediction is looked for."""
