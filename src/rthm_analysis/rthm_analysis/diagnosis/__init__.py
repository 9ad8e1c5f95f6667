"""When simulation and recording differ: where, what physics was left out, how big, how sure."""

from rthm_analysis.diagnosis.diagnose import diagnose, diagnose_together
from rthm_analysis.diagnosis.result import Diagnosis

__all__ = ["Diagnosis", "diagnose", "diagnose_together"]
