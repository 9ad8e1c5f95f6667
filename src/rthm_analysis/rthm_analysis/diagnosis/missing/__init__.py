"""The force that a model lacks, as a free curve over what it may depend on.

============  ===================================================================================
``motion``    position and velocity along the recording, noise kept out of the rates
``features``  free curves over motion, time and load, as sums of simple shapes
``binned``      averages of a force over another variable
``curves``    which of them predicts data that chose nothing, and by how much
``describe``  what was found in words: on what, when, which way, where it was seen
============  ===================================================================================

Along the recorded motion any force is a known load, whose size the response of the model tells by linear
regression. So a free curve costs one replay for each of its shapes, and is the yardstick of every kind: one
that does much worse is not the law.
"""
