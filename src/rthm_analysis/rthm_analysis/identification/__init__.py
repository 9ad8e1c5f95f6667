"""What a rig is, from a recording in which its motors were moved on purpose (`rthm_core.excitation`)."""

from rthm_analysis.identification.evidence import Motion, motions_of
from rthm_analysis.identification.identify import identified, identify
from rthm_analysis.identification.result import Figure, Identified

__all__ = ["Figure", "Identified", "Motion", "identified", "identify", "motions_of"]
