"""The second part: an open world, in which a diagnosis does not know what may be concealed.

Hybrid tests, and plants alone under a known force or in free decay, from rigs of micrometres and kilohertz to
ships of 0.1 Hz. All are simulated at the scale of the first part and then told in other units of length,
time and mass. ``python -m benchmarks.concealed.open`` makes the table; ``make_open_case`` one case by name.

===============  =========================================================================================
``scale``        the same motion in other units of length, time and mass
``worlds``       hybrid tests and plants alone, drawn at random
``truth``        what is concealed, and which answers state it rightly
``draft``        a case that is being made: told spec, true test, noise, faults of the recording
``noise``        noise that is not white
``faults``       what is wrong with a recording
``unlisted``     cases that no kind of the library is
``elsewhere``    more of them: hidden loads and masses, wire, motor, links
``spoiled``      cases with faults of the recording or of the spec
``parameters``   cases with other masses, dampings, stiffnesses, gains, offsets
``listed``       cases with one to three kinds of the library
``clean``        cases in which nothing is missing
``catalogue``    all names of cases, by class
``visibility``   how far above the noise something is that no linear model takes up
``bag``          the recording of a plant alone
``case``         one case
``plan``         which cases the table has
``score``        one diagnosis against its truth
``table``        all scores in words
===============  =========================================================================================
"""

from __future__ import annotations
