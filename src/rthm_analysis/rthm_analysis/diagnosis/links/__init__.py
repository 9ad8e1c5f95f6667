"""Links: whether samples are late, uneven, lost, or stamped by another clock.

===========  ============================================================================
stamps       by how much the stamps that a receiver read differ from the sender's
evidence     what the uses of a link say about the extra delay of every sample
host_stalls  what is left of this evidence where hosts stalled at times
stalls       samples whose fate a stalled host decided
models       distributions of the extra delay
fitting      their parameters, by likelihood
selection    which kinds are needed, judged on uses that took no part in the fit
ages         how old the sample in use is, as recorded and as a model expects it
limits       the smallest effects that would have been seen
energy       what older samples cost in energy
words        the findings for a test engineer
clocks       periods measured from stamps, where they are not the spec's
delays       a tau of the spec that is not the one with which the test was run
times        both as faults of the spec
finding      what one link shows
parts        all of it as a `Part`
===========  ============================================================================
"""

from rthm_analysis.diagnosis.links.parts import diagnose_links

__all__ = ["diagnose_links"]
