"""The physical side of a test: motors on their own, then wires, plant and sensors jointly.

===============  ==============================================================================
``side``         all of it, as `Part` of the diagnosis
``beginning``    free runs, noise, loads between samples, retuned model
``drives``       motors, whose position is measured
``judged``       errors on data that had no part in any fit or choice
``detection``    what a recording would have shown
``rounding``     sensors whose readings lie on a lattice
``binned``       averages of a force over another variable
``curves``       force that the plant lacks, over the variable that explains it best
``wire_curves``  the same of a wire
``work``         energy of what was found
``findings``     from what was found to a `Part`
===============  ==============================================================================
"""

from rthm_analysis.diagnosis.physical.side import diagnose_physical

__all__ = ["diagnose_physical"]
