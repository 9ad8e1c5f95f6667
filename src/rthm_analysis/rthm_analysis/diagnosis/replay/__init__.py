"""The recorded test, repeated with another model of motors, wires, plant and sensors.

==============  ===============================================================================
``evidence``    what went in, what was measured, and when
``joint``       several recordings as one
``between``     what a load did between two of its samples
``resolution``  how finely a replay has to go through time
``grid``        its time grid
``loads``       loads on the grid
``windows``     where free runs begin
``model``       the nominal spec, retuned parameters, added effects
``motor``       motor positions on the grid, from the commands as they fell due
``mechanics``   plant and wires of a spec, as the simulator's compiled code takes them
``switching``   compiled: where a law leaves its mode
``steps``       compiled: one step, to where a law leaves its mode
``kernel``      compiled: the replay of plant and wires
``sensing``     what the sensors make of the motion
``linear``      compiled: what many forces do to a linear plant
``budget``      how much of this one diagnosis may do
``experiment``  all of it: what a model predicts for the samples of the recording
==============  ===============================================================================
"""
