"""The test that is planned next: which motions are tried, how far they may go, and what they must tell."""

PLAN_GAIN_RATIO = 1.3
"""A planned test has to tell hypotheses apart by so many times as much as the present one."""

PLAN_SIMULATIONS = 80
"""Simulations of one plan, about 1 ms each for a loop with one dof a side; work and not time is counted, so
that a busy host plans the same."""

SMALLER_SIMULATIONS = 48
"""Simulations of all plans together that would show smaller effects, where nothing is to be told apart."""

PLAN_MOST_HYPOTHESES = 3
"""Hypotheses that are told apart at once: the likeliest come first."""

NO_DIFFERENCE = 1e-9
"""Difference of two hypotheses in the present test, over the noise, that counts as none."""

# How far a motion may go.

UNLIMITED_RANGE_RATIO = 2.0
"""How far beyond the range of the present test a signal without a limit may go: twice, as by hand."""

LIMIT_SHARE = 0.8
"""Share of a limit of the spec that a prediction may reach; what is not known of the rig needs the rest."""

BOUNDS_AGAIN_SHARE = 0.9
"""Share of the bounds at which a trial that went beyond them is tried again."""

REPEATED_BOUNDS_RATIO = 1.1
"""Share of the bounds that twice the present motion may use: a bound is twice that motion, and sizes are
rounded."""

# Which motions are tried.

TRIED_BAND = (0.4, 1.4)
"""Frequencies that are tried, over those of the slowest and the fastest mode."""

TRIED_BETWEEN = 4
"""Frequencies that are tried between the ends of the band, beside the modes."""

HARMONIC_FEWEST_PERIODS = 3.0
"""Fewest periods of a harmonic load within the test."""

HARMONIC_MOST_PERIODS = 30.0
"""Most of them, where no mode says what is fast."""

TRIED_AMPLITUDES = (1.0, 0.25)
"""Amplitudes over the largest: friction and play show in small motions, curved springs in large ones."""

TRIED_RELEASES = (2.0, 1.5, 0.5)
"""Initial motions over that of the present test."""

MULTISINE_WAVES = 20
"""Sinusoids of a multisine."""

REPEATED_AMPLITUDES = (2.0, 0.5)
"""Amplitudes over the present one; the larger says more where the limits allow it."""

REFINED_FREQUENCIES = (1.12, 1.04)
REFINED_AMPLITUDES = (0.5, 1.5)
"""Factors of the frequency in each round of refinement, and of the amplitude there."""

SWINGING_DAMPING_RATIO = 0.7
"""Largest damping ratio of a motion that has a frequency worth exciting."""

HIGHEST_MODE_RATIO = 6.0
"""Modes further above the slowest than by this factor are left out: a load at them moves little."""

UNSTABLE_GROWTH = 1e-6
"""Growth over the fastest rate below which it is rounding and no instability."""

# How it is predicted.

PREDICTED_STEP_RADIANS = 0.2
"""Longest step, in radians of the fastest motion of plant and wires."""

PREDICTED_STEP_TO_FILTER = 2.0
"""Longest step over the time of the fastest filter; a Runge-Kutta step of 2.8 is unstable."""

PREDICTED_MOST_STEPS = 6000
"""Steps of one prediction; a test that needs more is predicted over its first part."""

PRESENT_STEPS_RATIO = 20
"""Predictions of the present test may have so many times the steps of others."""

STRAIGHT_DELAY_RADIANS = 0.1
"""Delay, in radians of the fastest motion, up to which a straight line through position and velocity is right
to some thousandths; a filter would cost many short steps."""

LIGHT_MASS_SHARE = 0.01
"""Share of the mass up to which the inertia that a late damper seems to have does not matter."""
