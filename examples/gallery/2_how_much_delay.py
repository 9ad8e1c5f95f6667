"""
How much delay does a test stand?
=================================

A delay takes damping away until the loop grows by itself. Where that happens is exact: the loop over one
common multiple of its clocks is a matrix, and stable where its spectral radius is below one.
"""

import matplotlib.pyplot as plt
import numpy as np

import rthm

found = rthm.stability("paper")
print("stable" if found.stable else "not stable", f"with a spectral radius of {found.spectral_radius:.4f}")
for name in ("tau1", "tau2", "tau3", "tau4"):
    limit = found.limits[name]
    first = limit.scan.crossings[0].value
    print(f"{name}: {1e3 * limit.nominal:.0f} ms, lost above {1e3 * first:.0f} ms")

# %%
# How fast the loop grows or fades over two delays, every point a loop of its own:

tau2, tau3 = np.linspace(0.0, 0.1, 26), np.linspace(0.0, 0.1, 26)
loops = rthm.sweep("paper", {"timing.tau2": tau2, "timing.tau3": tau3}, 0.0)
rate = loops.columns()["growth_rate"].values.reshape(tau2.size, tau3.size)

figure, axis = plt.subplots(layout="constrained", figsize=(7, 4.5))
largest = np.abs(rate).max()
over = {"cmap": "RdBu_r", "vmin": -largest, "vmax": largest, "shading": "nearest"}
shown = axis.pcolormesh(1e3 * tau2, 1e3 * tau3, rate.T, **over)
axis.contour(1e3 * tau2, 1e3 * tau3, rate.T, levels=[0.0], colors="black")
axis.plot(8.0, 12.0, "k*", markersize=12)
axis.annotate("paper", (8.0, 12.0), xytext=(6, 6), textcoords="offset points")
axis.set(xlabel="tau2, ms", ylabel="tau3, ms")
figure.colorbar(shown, label="growth rate, 1/s (above 0: unstable)")
