"""Systems without a loop: a plant alone, the ideal system, and its first-order approximation.

The ideal system is (9): both substructures joined by the interface itself. The approximation is (25) with the
corrected (26). Both are a plant of n1 + n2 dofs without actuators, with the plant's effects where they were.

============  ===================================================================================
``body``      mass, damping and stiffness of the joined substructures
``motion``    their motion at any instants
``energies``  energies by quadrature between the rows
``run``       trajectory of a whole test
============  ===================================================================================
"""
