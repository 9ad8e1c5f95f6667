"""Faults of single samples: stuck values, drop-outs, spikes, ends of a range, motors that do not move."""

# Rest: a motion that has died away.

REST_FEWEST_SAMPLES = 50
"""Samples below which nothing says that a signal rests."""

REST_NOISE_RATIO = 1.3
"""Standard deviation of a signal over its noise, or the step of its sensor, up to which it rests."""

REST_KEPT_RATIO = 1.3
REST_LEAST_KEPT_SAMPLES = 300
"""Samples of a motion that are kept with the beginning of the rest that it ends in, over those of the motion:
its last seventh and this rest are the unseen part. And fewest for which the rest is left out."""

# Stuck: a sensor repeats one value.

STUCK_FEWEST_SAMPLES = 7
"""Samples of one value that chance does not make in a signal with noise."""

STUCK_TO_USUAL_LENGTH = 4.0
"""Length of a stretch in a signal that repeats values, over that of all but one in a hundred others."""

STUCK_SINGLE_SHARE = 0.98
"""Share of the values that are unlike their neighbours, in a signal that a sensor tells finely."""

NOISY_ALTERNATING_SHARE = 0.5
"""Share of the third differences that change sign, from which a signal carries noise; 0.1 where it is
smooth."""

STUCK_LEAP_RATIO = 2.0
"""Jump at the end of a stretch in a signal with noise, over the largest steps around it."""

STUCK_LEAP_RATIO_WITHOUT_NOISE = 6.0
"""The same in a position without noise: it has no other way to jump."""

STUCK_TRAVEL_SHARE = 0.3
"""Change of another channel meanwhile, over the range of that channel, that a sensor at work would show."""

ALIVE_CHANGE_RATIO = 0.5
"""Median change from sample to sample beside a stretch, over the usual one, of a signal that is alive."""

PADDED_SAMPLES = 100
"""Samples; a shorter stretch at the end of a recording is how some tools pad it."""

STUCK_NEIGHBOURS = 12
"""Samples on either side whose steps are compared."""

STUCK_RATE_SAMPLES = 10
"""Samples on either side over which a rate is taken; so near to its ends a stretch is not compared."""

HELD_FEWEST_STRETCHES = 3
"""So many short stretches are drop-outs of a link that holds its last value, rather than a sensor that
sticks."""

STUCK_SHORT_S = 0.1
"""Seconds; a longer stretch is a stuck sensor."""

STUCK_MOST_SHARE = 0.5
"""Share of a recording in stretches of one value above which it repeats values by itself, and nothing is
said."""

FEWEST_KNOWN_SHARE = 0.5
"""Share of the samples that must be known for stuck values, or ends of a range, to be looked for."""

# Drop-outs: samples that are missing or zero.

DROPOUT_FEWEST_SAMPLES = 4
"""Samples; shorter gaps are lost samples (shorter zeros: spikes)."""

SLOW_CHANNEL_GAP_SHARE = 0.2
"""Share of the samples; with more of them missing in short gaps, the channel is sampled less often, not
cut."""

SLOW_CHANNEL_FEWEST_GAPS = 20
"""Gaps of one length above which they come from slow sampling, where as many samples are missing in them."""

DROPOUT_TO_USUAL_LENGTH = 2.0
"""Length of a stretch, over that of all but two in a hundred others: coarse sensors repeat zeros, too."""

DROPOUT_JUMPING_SHARE = 0.5
"""Share of the stretches that begin and end with jumps, from which all are drop-outs: others fell on a
zero."""

DROPOUT_JUMP_STEPS = 4.0
"""Size of a jump over the step of a coarse sensor."""

DROPOUT_JUMP_TO_USUAL = 2.0
"""Size of a jump over that of all but one in a hundred steps."""

DROPOUT_DISTANCE_RMS = 0.05
"""A sample before and after a stretch of zeros must be so far from zero, over the signal's rms."""

# Spikes: samples far from their neighbours.

SPIKE_MOST_SAMPLES = 3
"""Samples; longer excursions can be motion."""

SPIKE_NEIGHBOURS = (4, 6)
"""Distances in samples of the neighbours that a sample is compared with: a spike never hides two of the
four."""

SPIKE_BLOCK = 256
"""Samples over which what is usual is judged: a quiet time does not make a lively one suspect."""

SPIKE_TO_USUAL_DISTANCE = 8.0
"""Size of a spike, over the distance from their neighbours that nine in ten samples nearby do not exceed."""

SPIKE_TO_USUAL_BEND = 5.0
"""Size of a spike, over the second difference that three in four samples nearby do not exceed: 14 standard
deviations of white noise."""

SPIKE_LEAST_STD_RATIO = 0.01
"""Size of a spike, over the spread of the signal; smaller ones spoil nothing that robust noise does not
cover."""

SPIKE_TO_COARSE_STEP = 4.0
"""Size of a spike over the step of a coarse sensor."""

SPIKE_CALM_SAMPLES = 4
"""Samples before and after a spike that say where the signal was and is again."""

SPIKE_RETURN_SHARE = 0.4
SPIKE_CALM_SHARE = 0.6
"""Share of a spike by which the signal may have moved on behind it, and by which it may change beside it."""

SPIKES_MOST_SHARE = 0.05
"""Share of the samples; a signal with more is of another kind, and nothing is said."""

SPIKE_BETWEEN_SHARE = 0.6
"""Share of the size of a spike from which samples stand between noise and spikes: where they are half as many
as spikes, it is noise of heavy tails."""

SEVERAL_SPIKES = 3
FEW_SPIKES_SIZE_RATIO = 2.0
"""Spikes that show what they are by their number; how much larger fewer have to be."""

SPIKE_TAIL_SHARE = 0.01
SPIKE_TAIL_EXPECTED = 0.02
"""Largest share of all excursions that tells how heavy the tail of noise is; number of excursions as large as
few spikes that such a tail may be expected to have."""

SPIKE_LARGEST_LOG_HEIGHT = 100.0
"""Logarithm of a height that nothing reaches."""

SEVERAL_SPIKES_MEDIAN_RATIO = 4.0
"""How much larger than need be several spikes are in the middle that no noise with heavy tails makes."""

SPIKE_EXPLAINED_SHARE = 0.3
"""Share of a spike from which what came before it explains it."""

SPIKE_TO_LARGE_STEPS = 2.0
"""Size of a spike of motor or force, over that of the large steps that commands make them take."""

# What commands do to motor and force.

COMMAND_TRACE_S = 0.025
"""Seconds by which a jump of a command may come before its traces in motor and force."""

STILL_TRAVEL_RATIO = 0.2
"""Travel of the position over a stretch, over that beside it, up to which a velocity of zero is true."""

LIVELY_COMMAND_RATIO = 3.0
"""Change of a command over such a time, over the usual one, that may make the force jump."""

DEAD_COMMAND_RATIO = 0.1
"""Travel of a command, over that of the liveliest position, from which its motor has to move."""

# Ends of a range.

RANGE_END_FEWEST_READINGS = 7
"""Readings at the end of a range that chance does not make."""

RANGE_END_MOST_SHARE = 0.6
"""Share of a recording at the end of a range from which nothing of the signal is left to go on with."""

RANGE_END_STDS = 4.0
"""Standard deviations of the noise within which readings beside an end are left out, too: of these, only the
lower ones were passed."""

# Rectified: a sensor gives magnitudes.

RECTIFIED_FEWEST_TURNS = 4
"""Changes of sign at zeros that have to be given back: what crosses zero less often may be a motion at its
limit."""

RECTIFIED_NEAR_ZERO_STDS = 4.0
"""Standard deviations of the noise; a reading so near to zero has no sign."""

RECTIFIED_NEAR_ZERO_SHARE = 0.02
"""The same over the signal's rms, where there is less noise."""

RECTIFIED_LEFT_SHARE = 0.2
"""What the relations to other channels leave open once the signs are given back, over before."""
