"""Models fitted to a recording by what they predict, judged in units of its noise.

===============  ==============================================================================
``noise``        how noisy a channel is
``sums``         normal equations by block of data: a fit, what it leaves open, its worth unseen
``cores``        work side by side
``steps``        steps of a fit
``fitting``      residuals, sensitivities, Levenberg-Marquardt, cross-validation
``wires_alone``  wires along the recorded motion of both their ends
``limits``       sizes at which effects would just have been seen
===============  ==============================================================================
"""
