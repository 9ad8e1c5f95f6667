"""
Where in frequency the delays matter
====================================

A load on the plant moves it; delays and holds change by how much, and when. The exactly sampled loop is
compared with the ideal system, with the delays alone, and with the paper's first-order approximation.
"""

import matplotlib.pyplot as plt
import numpy as np

import rthm

omega = np.geomspace(0.5, 20.0, 300)
found = rthm.response("paper", omega)

figure, axes = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(8, 5))
for way, style in {"ideal": "k--", "delays": "-", "taylor": ":", "sampled": "-"}.items():
    one = found.ways[way][:, 0, 0]
    axes[0].loglog(omega, 1e3 * np.abs(one), style, label=way)
    axes[1].semilogx(omega, np.degrees(np.unwrap(np.angle(one))), style)
axes[0].set_ylabel("x1 over load, mm/N")
axes[0].legend()
axes[1].set(xlabel="frequency, rad/s", ylabel="phase, degrees")

# %%
# At the resonances:

ideal, sampled = (np.abs(found.ways[way][:, 0, 0]) for way in ("ideal", "sampled"))
top = int(np.argmax(ideal))
print(f"{omega[top]:.2f} rad/s: ideal {1e3 * ideal[top]:.0f} mm/N, as sampled {1e3 * sampled[top]:.0f} mm/N")

# %%
# ``found.to_control()`` hands the response to python-control, if that is installed.
