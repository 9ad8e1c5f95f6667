"""
From a table to a model that fits
=================================

A rig and its logger give a table. Here a simulation stands for the rig: 1.2 kg on a spring of 12 N/m with
some dry friction that its data sheet does not have, let go at 0.5 m. From the table alone, what is missing
in the model?
"""

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np

import rthm
from rthm_core.spec import apply

folder = Path(mkdtemp())
rubbing = {
    "effects": ["guide"],
    "guide": {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.05},
}
rig = rthm.simulate(apply(rthm.load("decay"), rubbing), 25, sample=0.005)
measured = 1e3 * (rig.plant_position[:, 0] + np.random.default_rng(1).normal(0.0, 1e-4, rig.t.size))
table = folder / "decay.csv"
np.savetxt(
    table, np.column_stack([rig.t, measured]), delimiter=",", fmt="%.3f",
    header="Time [s],Displacement [mm]", comments="",
)  # fmt: skip
print("".join(table.open().readlines()[:3]), end="")

# %%
# The model that is believed in, and how well: the mass is exact, damping and stiffness are not.

model = apply(
    rthm.load("decay"), {"uncertainty": {"plant": {"mass": 0.0, "damping": 0.5, "stiffness": 0.02}}}
)
recording = rthm.import_table(table, folder / "bag", {"position:x1": "Displacement"}, model)

# %%
# Why do they differ? What follows is computed from the table; 0.05 N went in above.

answer = rthm.diagnose(recording)
print(answer.verdict)
print(answer.words)

# %%
# The patched spec has what was found, and runs like any other.

patched = folder / "patched.yaml"
patched.write_text(answer.patched)
before, after = rthm.simulate(model, 25, sample=0.005), rthm.simulate(patched, 25, sample=0.005)
figure, axes = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(8, 5))
axes[0].plot(rig.t, measured, color="#888888", label="measured")
axes[0].plot(before.t, 1e3 * before.plant_position[:, 0], label="model")
axes[0].plot(after.t, 1e3 * after.plant_position[:, 0], "--", label="patched model")
axes[0].set_ylabel("x1, mm")
axes[0].legend()
axes[1].plot(after.t, measured - 1e3 * after.plant_position[:, 0], linewidth=0.6)
axes[1].set(xlabel="t, s", ylabel="left over, mm")
