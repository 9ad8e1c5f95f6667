"""Faults of the recording: found and mended before any physics is looked for.

===============  ==============================================================================
``naming``       what a channel is called
``stretches``    stretches of samples
``commanded``    jumps and rests that the rig explains
``dropouts``     gaps, and zeros in their place
``stuck``        one value again and again while the rig moves
``spikes``       single samples that leave their neighbours and return
``smooth``       all signals through the same bell, with exact rates
``unit_ratios``  factors that a wrong unit makes
``relations``    what must hold between channels
``factors``      signs, units, swapped channels
``rectified``    magnitudes in place of signals
``plant``        mass and stiffness that known forces ask for
``known_loads``  sign and unit in a plain recording
``sensor_gains``  positions and velocities that read too much
``scaling``      signs, units and swaps in words
``drift``        clocks that drift apart
``spectra``      cross spectra
``lateness``     a constant delay, told from a lag
``delays``       which channel is late
``hum``          hum of the mains
``bend``         sensors that are not linear
``wander``       a sensor whose zero wanders
``belonging``    a spec of another test
``other_loop``   delays, periods and computing blocks of another test
``mending``      all of it, in order
===============  ==============================================================================
"""

from rthm_analysis.diagnosis.faults.mending import Mended, mend, with_motion

__all__ = ["Mended", "mend", "with_motion"]
