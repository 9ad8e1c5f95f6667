"""Loops in which everything is linear: a short program over step matrices.

===============  ==============================================================================
``loop``         both sides as matrices, and what passes between them
``ledger``       work as quadratic forms of the state, in tables
``preparation``  matrices over every length that a program needs
``kernel``       compiled: executes a program
``blocks``       rows of a span of time
``run``          rows of a whole test
===============  ==============================================================================
"""
