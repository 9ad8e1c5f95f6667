"""How a number is written, and which differences are worth a word."""

EXACT_STD_DIGITS = {1e-9: 9, 2e-6: 6}
"""Standard deviation over value up to which a number is told without it, and the digits that it then has: the
arithmetic of software, and what no rig does better."""

BOUND_STD_RATIO = 0.5
"""Standard deviation over value from which a number is told as a bound."""

UNTOLD_STD_RATIO = 3.0
"""Standard deviation over value from which not even a bound says anything."""

BOUND_STDS = 2.0
"""Standard deviations that a bound lies beyond the value."""

SMALLER_UNIT_BELOW = 0.1
"""Value below which the unit of a thousandth is used, and likewise the next."""

SECOND_DIGIT_BELOW = 3.0
"""First digits of a standard deviation below which it has a second one."""

PERCENT_MOST_DECIMALS = 3
"""Decimals of a percentage."""

WITHOUT_POWER_OF_TEN = (1e-4, 1e6)
"""Sizes between which a number needs no power of ten."""

FAR_STDS = 3.0
"""Stated standard deviations from which a new value is said to be far from what was expected."""

SLIGHT_CHANGE = 1e-3
"""Relative change that nobody has to look at."""

AT_BOUND_SHARE = 1e-3
"""Distance from a bound, as a share of it, at which a value has run into it."""

ALIKE_STDS, ALIKE_CHANGE = 3.0, 1e-3
"""Standard deviations, and change of a factor, within which mass, damping and stiffness are off alike."""

DRIVING_STDS = 3.0
"""Standard deviations below zero from which a damping or a stiffness is said to be so."""
