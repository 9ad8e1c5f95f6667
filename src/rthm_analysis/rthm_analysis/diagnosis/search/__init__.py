"""The search for what a model lacks: starting values, a cheap score for each kind, fits of the best.

===================  ========================================================================
``scene``            how large things are in a recording
``starts``           starting-value finders of plant, wires and sensors
``drive_starts``     those of motors
``tones``            those of harmonic loads
``tone_evidence``    what these have to show beyond their gain
``candidates``       every effect that there could be, with its starting values
``screening``        the score of every candidate from one replay each
``promising``        those that are worth a fit
``judging``          which fitted candidate is better, and whether one earns its place
``refining``         fits of the promising ones: the better they do, the longer
``wire_from_force``  wires identified from their measured force
``pairing``          effects that are found together only
``simplifying``      whether every effect is needed, and whether a plainer one would do
``replacing``        other kinds in the place of one, beside all others that were found
``pieces``           effects of which combinations are made
``subsets``          what every combination would leave
``tables``           the same by products of columns, many at once
``combining``        combinations that do better than what was found one by one
``driven_plant``     the plant alone, under the forces that were measured
``beside_wire``      what goes beside an effect of such a wire
``choosing``         effects added one at a time, as long as unseen data are predicted better
===================  ========================================================================
"""
