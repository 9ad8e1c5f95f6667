"""Concealed cases: recordings with physics that the spec does not know, and how well a diagnosis finds it.

Nothing here imports the project's packages: the equations are written once more from the contract's text,
with the paper's symbols, and integrated by classical Runge-Kutta with small fixed steps between the events of
the loop. ``python -m benchmarks.concealed`` makes the table of the first part.

==============  ==========================================================================================
``states``      the continuous states of the loop and what it remembers of its path, as indices
``motor``       command -> motor position u; lag, second order, rate limit, saturation, quantisation
``wire``        u, x1 -> force F; backlash, slack, hardening, pulley, hysteresis, relaxation
``plant``       F, w1 -> x1, v1; friction, drag, springs, contacts, hysteresis, memory, loads
``numerical``   z1 held -> x2, v2, F_d
``loads``       known loads w1, w2
``strange``     forces on the plant that no library of kinds has
``motion``      all of them over an interval without events, kinks located
``foresight``   the compensator `taylor`
``links``       delays, jitter, loss
``sensors``     what the recording shows of x1, v1, u, F
``loop``        the event order of the contract, from the first tick to the end of the test
``world``       spec -> the numbers of all the above
``simulate``    a test, or its plant alone under given commands
``draw``        stable tests drawn at random
``kinds``       the effects to conceal and their families
``amounts``     parameters that make an effect act at a given size
``visibility``  how far an effect moves the recorded channels, in units of their noise
``bag``         the recording as rosbag2 MCAP
``case``        one concealed case
``plan``        which cases the table has
``score``       one diagnosis against its truth
``table``       all scores in words
``runner``      cases one after the other, resumable; for both parts
``page``        the page of both parts
``open``        the second part: an open world
==============  ==========================================================================================
"""
