"""The physical side of a test: motors on their own, then wires, plant and sensors jointly.

===============  ==============================================================================
``side``         all of it, as `Part` of the diagnosis
``beginning``    free runs, noise, loads between samples, retuned model
``colours``      noise that has a colour
``whitening``    fits weighed by that colour
``filtered_noise``  noise that passes the lag of its sensor
``explaining``   from the retuned model to an explanation
``formula_first``  a formula before the long search
``formula_model``  terms of a formula as effects of a model
``leaves_noise``  whether a fit leaves nothing but noise
``late_sensors`` lags that are delays
``bent_sensors`` sensors that are not linear
``gains_told``   sensors that read too much or too little
``wandering``    a position that all other signals contradict
``shown_elsewhere``  what its error would be in them
``drifting_clocks`` a motion that comes later and later after the known force
``deviating``     what is wrong with a whole recording: lags and leaks
``fewer_kinds``  kinds that are not needed beside a formula
``fewer_terms``  terms that a formula does not need
``plainer_terms``  numbers that a term does not need
``foreseeing``    how far ahead a model tells a motion
``plainer``      other values of mass, damping, stiffness and wire, entry by entry
``drives``       motors, whose position is measured
``judged``       errors on data that had no part in any fit or selection
``remainder``    what is left beyond the noise, where and when
``contradicted``  errors of one channel that another denies
``unrelated``    errors that nothing in the rig foretells
``driven``       whether motors did what is known of them
``confirming``   unseen data confirm an effect or take it away
``verdict``      whether names were earned
``above_noise``  whether they are the law where more is left
``locating``     when something is missing
``composing``    from free curves to a formula, judged
``polygon``      a free curve itself as a law
``written``      a term of a formula with its values, in words
``formulated``   a formula as a finding
``acting``       when a force acts that does not act all the time
``term_by_term``  a formula in short runs, where a wrong model stays near
``inseparable``  what no recording of a motion tells apart
``parts_of_force``  a constant force or spring that may belong to a force that is left
``named_laws``   plain laws as kinds of the library
``named_formula``  the kinds that all terms of a formula are
``kinds_beside``  kinds of the library beside a formula
``unconfirmed``  what shows in the unseen part alone
``unforeseen``   a force that nothing foretells
``values``       what was found, with standard deviations
``fits``         errors of every signal, and of one free run
``detection``    what a recording would have shown
``rounding``     sensors whose readings lie on a lattice
``curves``       force that the plant lacks, over the variable that explains it best
``wire_curves``  the same of a wire
``offsets``      offsets of accelerometers
``loud``         noise that is louder than the spec says
``zeros``        zeros that differ from recording to recording
``own_zeros``    whether they do, and whether those of sensors or of forces
``zeros_told``   in words
``work``         energy of what was found
``findings``     from what was found to a `Part`
===============  ==============================================================================
"""

from rthm_analysis.diagnosis.physical.side import diagnose_physical

__all__ = ["diagnose_physical"]
