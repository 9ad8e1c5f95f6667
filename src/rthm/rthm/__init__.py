"""Real-time hybrid testing from Python: simulate a test, read a recording, find out why the two differ.

>>> import rthm
>>> run = rthm.simulate("paper", 20)
>>> f"{run.energies['E_err'][-1]:.2f} J"
'-1.27 J'

A spec is named by the name of a shipped one, by a path, or is one that `load` returned. Numbers are SI. Bad
input raises `InputError`, a sentence with the way out. Nothing is computed here: each function hands over to
the package that does it, which is imported when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rthm.components import component
    from rthm.recordings import diagnose, energy, import_table, read, timing
    from rthm.simulations import sensitivities, simulate, simulate_many
    from rthm.specs import load
    from rthm.sweeps import sweep
    from rthm.theory import response, stability
    from rthm_core.effects import Effect
    from rthm_core.errors import InputError

    __version__: str

__all__ = [
    "Effect",
    "InputError",
    "__version__",
    "component",
    "diagnose",
    "energy",
    "import_table",
    "load",
    "read",
    "response",
    "sensitivities",
    "simulate",
    "simulate_many",
    "stability",
    "sweep",
    "timing",
]

_PLACES = {
    "Effect": "rthm_core.effects",
    "InputError": "rthm_core.errors",
    "component": "rthm.components",
    "diagnose": "rthm.recordings",
    "energy": "rthm.recordings",
    "import_table": "rthm.recordings",
    "load": "rthm.specs",
    "read": "rthm.recordings",
    "response": "rthm.theory",
    "sensitivities": "rthm.simulations",
    "simulate": "rthm.simulations",
    "simulate_many": "rthm.simulations",
    "stability": "rthm.theory",
    "sweep": "rthm.sweeps",
    "timing": "rthm.recordings",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("rthm_core")  # all packages have one version
    if name not in _PLACES:
        raise AttributeError(f"rthm has no {name!r}, only {', '.join(__all__)}.")
    found = getattr(import_module(_PLACES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
