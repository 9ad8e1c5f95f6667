"""Loops whose plant has laws that are not linear, as one linear system into which their forces are fed.

==============  ==================================================================================
``loop``        the linear systems, one for each set of dofs that stick
``steps``       steps driven by polynomials in time, as matrices and as series
``switch``      where on its way a motion leaves the mode of a law
``advance``     steps with collocated forces, up to the next switch
``event_free``  steps in which forces are constant and nothing switches
``kernel``      compiled: executes a program
``run``         rows of a whole test
==============  ==================================================================================
"""
