"""Optional physics, one small class per kind: equation, parameters with units, words, where it sits."""

from rthm_core.effects.base import BLOCKS, Effect, EffectParameter, EffectText, effect, kinds, register

__all__ = ["BLOCKS", "Effect", "EffectParameter", "EffectText", "effect", "kinds", "register"]
