"""
What delays and sampling do to a test
=====================================

The paper's test has two masses and one wire, four delays, four clocks. Without delays and holds it would be
the ideal system; with them, energy goes in or out on the way around the loop.
"""

import matplotlib.pyplot as plt
import numpy as np

import rthm

run = rthm.simulate("paper", 20)
ideal = rthm.simulate("paper", 20, system="ideal")

figure, axes = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(8, 5))
axes[0].plot(ideal.t, 1e3 * ideal.plant_position[:, 0], color="#888888", label="ideal")
axes[0].plot(run.t, 1e3 * run.plant_position[:, 0], label="hybrid test")
axes[0].set_ylabel("x1, mm")
for term in ("E_num", "E_ff", "E_fx", "E_err"):
    axes[1].plot(run.t, run.energies[term], label=term)
axes[1].set(xlabel="t, s", ylabel="J, + when put in")
for axis in axes:
    axis.legend()

# %%
# What comes from where: the numerical side works with an old position (``E_num``), the feedforward is late
# (``E_ff``), and the controller cancels the plant's motion late (``E_fx``). Their sum is the error of the
# test in joules.

for term in ("E_num", "E_ff", "E_fx", "E_err"):
    print(f"{term:6} {run.energies[term][-1]:+.4f} J")

# %%
# As an error of the motion, over the rms of the ideal motion:

error = run.plant_position[:, 0] - ideal.plant_position[:, 0]
nrmse = np.sqrt(np.mean(error**2) / np.mean(ideal.plant_position[:, 0] ** 2))
print(f"x1 is off by {100 * nrmse:.1f} % of the ideal motion")

# %%
# Nothing was lost on the way: the check of the energy balance is rounding.

print(f"balance error below {10.0 ** np.ceil(np.log10(np.abs(run.balance_error).max())):.0e} J")
