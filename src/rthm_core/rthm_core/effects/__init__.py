"""Optional physics, one small class per kind: equation, parameters with units, words, where it sits."""

from rthm_core.effects.blocks import BLOCKS
from rthm_core.effects.declaration import Effect, EffectParameter, EffectText
from rthm_core.effects.guess import Guess, Signals
from rthm_core.effects.laws import PlantLaw, WireLaw
from rthm_core.effects.own import load_effects
from rthm_core.effects.possible import Plainer, Twin
from rthm_core.effects.registry import effect, kinds, register

__all__ = [
    "BLOCKS",
    "Effect",
    "EffectParameter",
    "EffectText",
    "Guess",
    "Plainer",
    "PlantLaw",
    "Signals",
    "Twin",
    "WireLaw",
    "effect",
    "kinds",
    "load_effects",
    "register",
]
