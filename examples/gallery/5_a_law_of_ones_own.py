"""
A law of one's own
==================

A linear motor cogs: its magnets pull the carriage to certain places. The library has no such kind; one
class declares it, and from then on it is simulated, run in nodes and looked for by the diagnosis.
"""

import math

import matplotlib.pyplot as plt

import rthm
from rthm_core.effects import EffectParameter, PlantLaw, register
from rthm_core.spec import apply


@register
class Cogging(PlantLaw):
    """Force of magnets, which repeats itself along the way."""

    kind = "gallery_cogging"
    blocks = ("plant",)
    parameters = {
        "amplitude": EffectParameter("N", "amplitude"),
        "period": EffectParameter("m", "way after which the force repeats itself", above=0.0),
    }
    equation = "F = A sin(2 pi x / period)"
    depends_on = ("x",)
    words = "a cogging force of {amplitude}, which repeats itself every {period}, acts on {dof}"

    @staticmethod
    def force(x, v, z, t, p, mode):
        return p[0] * math.sin(2.0 * math.pi * x / p[1])


magnets = {"block": "plant", "kind": "gallery_cogging", "dof": "x1", "amplitude": 0.4, "period": 0.12}
paper = rthm.load("paper")
plain = rthm.simulate(paper, 20)
cogging = rthm.simulate(apply(paper, {"effects": ["magnets"], "magnets": magnets}), 20)

figure, axis = plt.subplots(layout="constrained", figsize=(8, 3.5))
axis.plot(plain.t, 1e3 * plain.plant_position[:, 0], color="#888888", label="without magnets")
axis.plot(cogging.t, 1e3 * cogging.plant_position[:, 0], label="with magnets")
axis.set(xlabel="t, s", ylabel="x1, mm")
axis.legend()

# %%
# Their work over the test. They give back what they take; what is left is the energy of the place where it
# ends:

print(f"{cogging.energies['E_effects'][-1]:+.4f} J")
