"""Many loops that differ in their numbers.

==============  ===============================================================================
``lane_steps``  steps of eight systems at once
``states``      states of eight loops at once, in registers where they are small
``lanes``       loops with the same clocks, eight side by side
``numbered``    the program that these share, by places in the memory of eight loops
``delayed``     one plain loop with clocks and delays of its own, without preparation
``ensemble``    which of the two, and the results of all
==============  ===============================================================================
"""
