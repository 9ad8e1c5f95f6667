"""Many loops that differ in their numbers.

============  =================================================================================
``lanes``     loops with the same clocks, side by side in SIMD registers
``delayed``   one plain loop with clocks and delays of its own, without preparation
``ensemble``  which of the two, and the results of all
============  =================================================================================
"""
