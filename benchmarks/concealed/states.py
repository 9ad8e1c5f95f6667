"""Names of the numbers that describe the loop between two events."""

from __future__ import annotations

# Continuous states.
(
    X1,  # plant: position, velocity
    V1,
    X2,  # numerical substructure: position, velocity
    V2,
    POLE_V,  # motor: behind the pole kv, behind the pole ka
    POLE_A,
    LAG,  # motor: behind the lag
    SECOND,  # motor: behind the second order, and its rate
    SECOND_RATE,
    YIELD,  # plant: z of Bouc-Wen
    RELAX,  # plant: position of Maxwell's damper
    HUNG,  # plant: position and velocity of the hidden mass
    HUNG_RATE,
    WAVE,  # plant: r and dr of the fluid memory
    WAVE_RATE,
    WIRE_RELAX,  # wire: elongation of Maxwell's damper
    PULLEY,  # wire: position and velocity of the pulley
    PULLEY_RATE,
    SEEN_X,  # sensors: position, velocity and force behind their lags
    SEEN_V,
    SEEN_F,
    INNER,  # plant: what a force outside the library remembers, and its rate
    INNER_RATE,
) = range(23)
STATES = 23

# Memory of the path: moves with it, but not by a differential equation in time.
(
    SLEW,  # motor: output of the rate limit
    DRIVE,  # wire: far end of the backlash
    RUB,  # wire: pulley that rubs
    ELONGATION,  # wire: elongation at the last step, and z of Bouc-Wen there
    WIRE_YIELD,
    MODE,  # friction: +1 or -1 direction of sliding, 0 sticks
) = range(6)
MEMORY = 6
