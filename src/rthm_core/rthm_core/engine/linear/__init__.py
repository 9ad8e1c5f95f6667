"""Loops in which everything is linear: a short program over step matrices.

===============  ==============================================================================
``loop``         both sides as matrices, and what passes between them
``ledger``       work as quadratic forms of the state, in tables
``totals``       the same from fewer numbers
``vectors``      states in the kernel, and what matrices make of them
``periods``      compiled: work of eight periods at once
``looks``        when that is looked at, and its coefficients
``preparation``  matrices over every length that a program needs
``kernel``       compiled: executes a program
``streams``      compiled: where events do not repeat, from instant to instant of the clocks
``arrivals``     what commands add that arrive between two of these; ``arriving``: compiled
``blocks``       rows of a span of time
``irregular``    rows of a test whose events do not repeat
``run``          rows of any
===============  ==============================================================================
"""
