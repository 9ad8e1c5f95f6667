"""Zeros of sensors that differ from recording to recording of one rig."""

ZERO_SHARE = 0.5
"""Share of what a model leaves above the noise that zeros of each recording's own remove beyond one that all
share: physics that bends a motion to one side, the more the larger it is, leaves most of it in the motion."""

ZERO_STDS = 5.0
"""Standard deviations by which a zero differs in one recording from its mean over all."""

ZERO_ROUNDS = 2
"""Steps of Gauss and Newton: the first finds a zero but for what is not linear over its size, the second what
is left of that."""

ZERO_WORTH_SHARE = 0.2
"""`ZERO_SHARE` behind the first step, below which the second does not make a difference of it."""

ZERO_SEEN_SHARE = 1e-6
"""Share of a constant that states in which runs begin leave over; below, they stand for it."""

ZERO_TIE_SHARE = 0.1
"""Share of what is left above the noise by which a zero and a constant force leave as much: what is missing
beside them favours one of them by about that much."""

ZERO_TRIAL_SHARE = 1e-3
"""Trial force, over what the spring of its dof makes of the motion."""
