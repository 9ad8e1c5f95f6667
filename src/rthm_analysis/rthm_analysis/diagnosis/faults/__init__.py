"""Faults of the recording: found and mended before any physics is looked for.

===============  ==============================================================================
``naming``       what a channel is called
``stretches``    stretches of samples
``unit_ratios``  factors that a wrong unit makes
``commanded``    jumps that commands explain
``dropouts``     gaps, and zeros in their place
``stuck``        one value again and again while the rig moves
``spikes``       single samples that leave their neighbours and return
``smooth``       all signals through the same bell, with exact rates
``relations``    what must hold between channels
``factors``      signs, units, swapped channels
``scaling``      these in words
``mending``      all of it, in order
===============  ==============================================================================
"""

from rthm_analysis.diagnosis.faults.mending import Mended, mend

__all__ = ["Mended", "mend"]
