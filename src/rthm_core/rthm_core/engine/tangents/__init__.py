"""Tangents: how a loop and its motion change with parameters, beside the motion itself.

===========  ==================================================================================
``changes``  of the loop's matrices, held forces and start
``entries``  matrices and their changes as streams of numbers
``steps``    tangents over a step without a switch
``advance``  up to the next switch, and across it
``kernel``   compiled: what ``nonlinear`` executes, with tangents beside it
===========  ==================================================================================
"""
