"""The force that a model lacks: as a free curve over what it may depend on, then as a formula.

============  ===================================================================================
``motion``    position and velocity along the recording, noise kept out of the rates
``residual``  the force that would make what a model leaves of the motion
``features``  free curves over motion, time and load, as sums of simple shapes
``binned``    averages of a force over another variable
``likely``    which of them are worth a replay
``normal``    normal equations by block, and what they leave of data left out
``curves``    which of them predicts data that chose nothing, and by how much
``describe``  what was found in words: on what, when, which way, where it was seen
``shapes``    the grammar: shapes over one variable, and where a fit of each may begin
``terms``     a factor that is known, and shapes over one or two variables
``recurring`` factors that swing with time, and forces that recur along the way
``plain``     laws without numbers of their own that explain it together
``formulas``  terms that explain as much as the best curve
``within``    terms of a force that acts in an interval alone
============  ===================================================================================

Along the recorded motion any force is a known load, whose size the response of the model tells by linear
regression. So a free curve costs one replay for each of its shapes, and is the yardstick of every kind: one
that does much worse is not the law.
"""
