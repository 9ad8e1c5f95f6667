"""Fig. 2: what a hold, a delay and a second hold do to a signal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import paper
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import legend_above, panels
from rthm_core.compensation import mean_age
from rthm_core.link import Link
from rthm_core.schedule import newest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BEGIN_NS, LENGTH_NS, STEP_NS = 24_000_000, 30_000_000, 10_000
"""What is shown begins at a tick of all clocks that has samples behind it."""

SIGNAL_PERIOD = 0.040
"""Of the sample signal, s."""


def _signal(t: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(2.0 * np.pi * (t - BEGIN_NS * 1e-9) / SIGNAL_PERIOD))


def compute() -> Numbers:
    """The signal on the way to the controller with the times of Table I: zoh1, tau1, zoh3."""
    spec = paper()
    timing = spec.loop().timing
    td1, td3, tau1 = timing.ns("td1"), timing.ns("td3"), timing.ns("tau1")
    t = BEGIN_NS + np.arange(0, LENGTH_NS + 1, STEP_NS, dtype=np.int64)
    held = newest(Link(spec, "tau1"), td1, t // td3 * td3)
    sampled, delayed = t // td1 * td1, (t - tau1) // td1 * td1
    columns = {"t [s]": (t - BEGIN_NS) * 1e-9, "f [1]": _signal(t * 1e-9)}
    for name, stamp in (("f(zoh1) [1]", sampled), ("f([zoh1, tau1]) [1]", delayed)):
        columns[name] = _signal(stamp * 1e-9)
    columns["f([zoh1, tau1, zoh3]) [1]"] = _signal(held * td1 * 1e-9)
    columns["age [s]"] = (t - held * td1) * 1e-9
    mean = mean_age(timing, "tau1", "td1", "td3") + 0.5 * timing.td3
    rule = timing.tau1 + 0.5 * (timing.td1 + timing.td3)
    ticks = BEGIN_NS + np.arange(0, 12_000_000, td3, dtype=np.int64)
    latched = (ticks - newest(Link(spec, "tau1"), td1, ticks) * td1) * 1e-9
    values = {"mean age [s]": mean, "tau1' of (20b) [s]": rule}
    return Numbers(
        {"signal": columns},
        values | {"least age at a latch [s]": latched.min(), "largest age at a latch [s]": latched.max()},
    )


def found(numbers: Numbers) -> str:
    """What the varying hold amounts to."""
    v = numbers.values
    return (
        f"The second hold takes samples that are {v['least age at a latch [s]'] * 1e3:.1f} to "
        f"{v['largest age at a latch [s]'] * 1e3:.1f} ms old: its hold time T'd3 varies. With clocks in "
        f"phase the mean age is {v['mean age [s]'] * 1e3:.1f} ms, not the {v[_RULE] * 1e3:.1f} ms of (20b)."
    )


_RULE = "tau1' of (20b) [s]"


def draw(numbers: Numbers) -> Figure:
    """Signal and steps; age below."""
    columns = numbers.tables["signal"]
    t = columns["t [s]"] * 1e3
    figure, axes = panels(2, height=3.1, sharex=True, height_ratios=[2.2, 1.0])
    top, low = axes[:, 0]
    top.plot(t, columns["f [1]"], color="#222222", linewidth=1.0, label=r"$f(t)$")
    looks = (
        ("f(zoh1) [1]", "#9aa5b1", r"$f(t, zoh_1)$"),
        ("f([zoh1, tau1]) [1]", "#e69f00", r"$f(t, [zoh_1, \tau_1])$"),
        ("f([zoh1, tau1, zoh3]) [1]", "#0072b2", r"$f(t, [zoh_1, \tau_1, zoh_3])$"),
    )
    for name, colour, label in looks:
        top.plot(t, columns[name], color=colour, linewidth=1.1, drawstyle="steps-post", label=label)
    top.set_ylabel(r"$f$  (1)")
    legend_above(top, 2)
    low.plot(t, columns["age [s]"] * 1e3, color="#0072b2", linewidth=1.0)
    low.axhline(numbers.values["mean age [s]"] * 1e3, color="#222222", linewidth=0.8, linestyle=(0, (4, 2)))
    low.text(0.995, 0.06, "dashed: mean", transform=low.transAxes, ha="right", fontsize=6.6)
    low.set(xlabel="time  (ms)", ylabel="age  (ms)", xlim=(0.0, 30.0), ylim=(0.0, 10.0))
    return figure


FIGURE = Plate(
    "figure02",
    "Fig. 2: hold and delay on a signal",
    "A hold on a signal that is already sampled gives a varying hold time; on a smooth signal a short hold "
    "acts as a delay of half its period.",
    False,
    compute,
    found,
    draw,
)
