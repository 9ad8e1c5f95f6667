"""Energy balance of a recorded or running test."""

from rthm_analysis.energy.ledger import EnergyLedger, Rows
from rthm_analysis.energy.rehearsal import rehearse
from rthm_analysis.energy.result import EnergyResult, energy_of

__all__ = ["EnergyLedger", "EnergyResult", "Rows", "energy_of", "rehearse"]
