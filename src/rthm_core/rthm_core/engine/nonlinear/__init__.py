"""Loops whose plant has laws that are not linear, as one linear system into which their forces are fed.

===============  =================================================================================
``loop``         the linear systems, one for each set of dofs that stick
``steps``        steps driven by polynomials in time, as matrices and as series
``operations``   a program with its lengths numbered, and its arcs: what lies between two commands
``packed``       matrices of steps as SIMD values
``tables``       work over every length
``forces``       what laws and wires do at an instant
``collocation``  a step over which forces are polynomials
``switch``       where on its way a motion leaves the mode of a law
``event_free``   whether nothing switches over a step with constant forces
``arc``          a whole arc as one step, and what is seen on the way
``advance``      steps within an arc, up to the next switch
``kernel``       compiled: executes a program
``run``          rows of a whole test
===============  =================================================================================
"""
