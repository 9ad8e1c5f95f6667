"""The physical side of the loop: motor, wire and plant, with whatever effects the spec adds."""

from rthm_core.physical.side import PhysicalSample, PhysicalSide

__all__ = ["PhysicalSample", "PhysicalSide"]
