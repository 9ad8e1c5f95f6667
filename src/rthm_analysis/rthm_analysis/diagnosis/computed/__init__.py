"""Blocks that compute: whether they compute with the values of the spec.

What they got and what they gave is recorded without noise, so a replay is exact but for the loads between
their samples, and what is wrong can be named from small differences.

================  =================================================================================
``latched``       the samples that a block held at its ticks
``controller``    u_d from x1 and F_d
``replayed``      what a controller computes from the samples that it used
``compensators``  which compensator the commands show
``control``       the diagnosis of the controller
``structure``     the numerical substructure as matrices, its exact step, its parameters
``numerical``     which of its parameters is wrong
``parts``         both as a `Part`; ``common`` is what they share
================  =================================================================================
"""

from rthm_analysis.diagnosis.computed.parts import diagnose_computed

__all__ = ["diagnose_computed"]
