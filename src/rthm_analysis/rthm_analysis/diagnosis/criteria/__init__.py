"""Every number that decides something: what it bounds, in which unit, and why it has this value.

==============  ==========================================================================================
``samples``     faults of single samples: stuck values, drop-outs, spikes, ends of a range
``signals``     faults of whole signals: signs, units, hum, lateness, another rig than that of the spec
``readings``    sensors that are not linear, noise that is not what the spec says
``links``       delays, losses, stalls and clocks of the links
``computed``    numerical side, controller and compensators, computed again
``replay``      how exactly the physical side is simulated again, and for how long
``fitting``     when a fit is as good as it gets, and what its standard deviations are worth
``noise``       what is noise, with or without a colour, and what is left beyond it
``zeros``       whether zeros of sensors differ from recording to recording
``search``      what a kind of physics must bring to be named before others
``missing``     when a free curve of the missing force is told
``verdict``     when the names that were found explain a recording
``experiment``  the test that is planned next
``words``       how a number is written, and which differences are worth a word
==============  ==========================================================================================

The words are those of statistics. A **squared error in units of the noise** is the sum of squared residuals,
each over its standard deviation; where nothing but noise is left, it is about the number of samples. The
**reduced chi-squared** is the same per sample: 1 at the noise. A **gain** is a difference of two squared
errors, mostly of **cross-validated** ones: each part of the data is predicted by values that were fitted to
the other parts. A **mismatch** is what a model leaves above the noise, and a **share** a part of it, or of a
variance, between 0 and 1. **Unseen** data are the last third of a recording, which no fit and no choice has
used. The **slow residual** is what a model leaves, averaged over 16 samples at a time: white noise has a
power of 1 there as well, and physics more. A gain in the **logarithm of the likelihood** is half of one in
squared error.

Chance, arithmetic and cost give some numbers their values. Most others lie between what recordings show with
what is looked for and without it; the docstring tells either side where it is known. A docstring below
several numbers is about all of them, in their order.
"""
