"""Misprints of the paper, each with a check in numbers."""

from __future__ import annotations

from rthm_analysis.reproduce.errata import energy_balance, expansion, model, remarks
from rthm_analysis.reproduce.errata.erratum import Erratum

__all__ = ["Erratum", "all_errata"]

CHECKS = (*model.CHECKS, *energy_balance.CHECKS, *expansion.CHECKS, *remarks.CHECKS)


def all_errata() -> tuple[Erratum, ...]:
    """Run every check."""
    return tuple(check() for check in CHECKS)
