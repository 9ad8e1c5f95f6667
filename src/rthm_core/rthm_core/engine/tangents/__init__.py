"""Tangents: how a loop and its motion change with parameters, beside the motion itself.

==============  ===============================================================================
``changes``     of the loop's matrices, held forces, numbers of laws and start
``entries``     matrices and their changes as streams of numbers
``steps``       tangents over a step without a switch
``advance``     up to the next switch, and across it
``kernel``      compiled: what ``nonlinear`` executes, with tangents beside it
``slopes``      how forces of laws and wires change with the motion and with parameters
``polynomial``  tangents over a step whose forces are polynomials in time
``implicit``    tangents of forces that follow from the motion which they drive
``within``      such steps up to the next switch, and across it
``following``   memory of tangents that follow such a motion
``followed``    compiled: what ``nonlinear`` executes there, with tangents beside it
``run``         which kernel runs a loop, and with which memory
==============  ===============================================================================
"""
