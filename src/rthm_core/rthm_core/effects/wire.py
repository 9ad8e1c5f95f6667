"""What a wire does beside ``k_tot (u - x)``; sorted from the motor to the plant."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals, rms
from rthm_core.effects.hysteresis import (
    BOUC_WEN_ALONG,
    BOUC_WEN_EXPERIMENT,
    BOUC_WEN_NOUN,
    BOUC_WEN_PARAMETERS,
    BOUC_WEN_POSSIBLE,
    BOUC_WEN_POWERS,
    BOUC_WEN_SECONDARY,
    loops,
    yield_force,
)
from rthm_core.effects.laws import WireLaw
from rthm_core.effects.memory import MAXWELL_EXPERIMENT, MAXWELL_NOUN, relaxations
from rthm_core.effects.possible import Plainer, less_than_the_dof, relaxing
from rthm_core.effects.registry import register


@register
class Backlash(WireLaw):
    """Play between the measured motor position and the wire: the far end moves only once the gap is used
    up.
    """

    kind = "backlash"
    blocks = ("wire",)
    parameters = {"gap": EffectParameter("m", "total width of the play", minimum=0.0)}
    equation = "F = k (y - x); y follows u with play gap/2 on either side"
    depends_on = ("x", "u")
    words = "the drive of {actuator} has a backlash of {gap}"
    experiment = "Reverse the motor slowly under a small load."
    states = 1
    order = 0
    path = (1.0, 0.0)
    kinked = True
    rank = 10

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Nearly linear in a small gap; a larger one moves the plant otherwise."""
        for part in (TRIAL_FORCE, 0.1, 0.4):
            yield Guess({"gap": part * rms(signals.elongation)}, ("gap",))

    @staticmethod
    def drive(u, z, p):  # type: ignore[no-untyped-def]
        return z[0]

    @staticmethod
    def settle(u, x, k, z, p):  # type: ignore[no-untyped-def]
        z[0] = min(max(z[0], u - 0.5 * p[0]), u + 0.5 * p[0])

    @staticmethod
    def initial(u, x, p):  # type: ignore[no-untyped-def]
        return (u,)


@register
class PulleyInertia(WireLaw):
    """Pulley with mass in the middle of the wire: a mass between two springs of 2 k, to the motor and to the
    plant.
    """

    kind = "pulley_inertia"
    blocks = ("wire",)
    parameters = {
        "mass": EffectParameter("kg", "mass as felt at the wire", minimum=1e-9),
        "damping": EffectParameter("N s/m", "damping as felt at the wire", minimum=0.0),
    }
    equation = "F = 2 k (y - x); m ddy = 2 k (u - y) - 2 k (y - x) - c dy"
    depends_on = ("x", "u")
    words = "the pulley of {actuator} is not massless: {mass} moves with the wire"
    noun = "inertia of the pulley"
    experiment = "Sweep the motor with the dof locked."
    possible = {"mass": less_than_the_dof}
    secondary = ("damping",)
    states = 2
    order = 1
    linear = True
    rank = 40

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Half a per cent of the dof's mass, and pulleys that would ring as the wire's force does."""
        masses = [5e-3 * signals.mass]
        masses += [4.0 * signals.stiffness / w**2 for w in signals.ringing(3.0 * signals.frequency)]
        for mass in masses:
            damping = 0.05 * np.sqrt(signals.stiffness * mass)
            yield Guess({"mass": mass, "damping": damping}, ("mass", "damping"), apart=True)

    @staticmethod
    def force(u, x, v, k, f, z, p):  # type: ignore[no-untyped-def]
        return f + 2.0 * k * (z[0] - x) - k * (u - x)

    @staticmethod
    def rate(u, x, v, k, z, p, dz):  # type: ignore[no-untyped-def]
        dz[0] = z[1]
        dz[1] = (2.0 * k * (u + x - 2.0 * z[0]) - p[1] * z[1]) / p[0]

    @staticmethod
    def initial(u, x, p):  # type: ignore[no-untyped-def]
        return (0.5 * (u + x), 0.0)


@register
class PulleyFriction(WireLaw):
    """Massless pulley with dry friction in the middle of the wire: it moves only when the two halves pull
    unequally enough.
    """

    kind = "pulley_friction"
    blocks = ("wire",)
    parameters = {"force": EffectParameter("N", "friction force at the pulley", minimum=0.0)}
    equation = "F = 2 k (y - x); y follows (u + x)/2 with play F_f/(4 k) on either side"
    depends_on = ("x", "u")
    words = "the pulley of {actuator} rubs: it holds back up to {force} before it turns"
    noun = "friction of the pulley"
    experiment = "Reverse the motor slowly with the dof locked."
    states = 1
    order = 2
    path = (0.5, 0.5)
    kinked = True
    rank = 50

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Nearly linear in a small force."""
        yield Guess({"force": 2.0 * TRIAL_FORCE * signals.size}, ("force",))

    @staticmethod
    def force(u, x, v, k, f, z, p):  # type: ignore[no-untyped-def]
        return f + 2.0 * k * (z[0] - x) - k * (u - x)

    @staticmethod
    def settle(u, x, k, z, p):  # type: ignore[no-untyped-def]
        play = p[0] / (4.0 * k)
        middle = 0.5 * (u + x)
        z[0] = min(max(z[0], middle - play), middle + play)

    @staticmethod
    def initial(u, x, p):  # type: ignore[no-untyped-def]
        return (0.5 * (u + x),)


@register
class Hardening(WireLaw):
    """Wire that stiffens with the cube of its elongation."""

    kind = "hardening"
    blocks = ("wire",)
    parameters = {"coefficient": EffectParameter("N/m^3", "force per cubed elongation")}
    equation = "F = k d + c d^3, d = u - x"
    depends_on = ("x", "u")
    words = (
        "the wire of {actuator} is not linear: its force grows with the cube of its elongation, "
        "by {coefficient}"
    )
    noun = "a hardening wire"
    experiment = "Pull statically at the wire to several elongations."
    order = 3
    rank = 30

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Linear in its coefficient, of either sign."""
        coefficient = TRIAL_FORCE * signals.size / rms(signals.elongation**3)
        yield Guess({"coefficient": coefficient}, ("coefficient",), signed=True)

    @staticmethod
    def force(u, x, v, k, f, z, p):  # type: ignore[no-untyped-def]
        return f + p[0] * (u - x) ** 3


@register
class WireMaxwellBranch(WireLaw):
    """Spring and damper in series beside the wire's own spring: a wire that relaxes."""

    kind = "maxwell_branch"
    flexible = True
    blocks = ("wire",)
    parameters = {
        "stiffness": EffectParameter("N/m", "spring of the branch", minimum=0.0),
        "damping": EffectParameter("N s/m", "damper in series with it", minimum=1e-12),
    }
    equation = "F = k d + k_b (d - y); c dy/dt = k_b (d - y), d = u - x"
    depends_on = ("x", "u")
    words = (
        "the wire of {actuator} relaxes: a branch of {stiffness} in series with {damping} acts "
        "beside it (Maxwell)"
    )
    noun = MAXWELL_NOUN
    experiment = MAXWELL_EXPERIMENT
    possible = {"damping": relaxing}
    states = 1
    order = 4
    linear = True
    rank = 70

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Relaxation slower than, as fast as and faster than the motion."""
        yield from relaxations(signals, rms(signals.elongation))

    @staticmethod
    def force(u, x, v, k, f, z, p):  # type: ignore[no-untyped-def]
        return f + p[0] * (u - x - z[0])

    @staticmethod
    def rate(u, x, v, k, z, p, dz):  # type: ignore[no-untyped-def]
        dz[0] = p[0] / p[1] * (u - x - z[0])

    @staticmethod
    def initial(u, x, p):  # type: ignore[no-untyped-def]
        return (u - x,)


@register
class WireBoucWen(WireLaw):
    """Hysteretic wire. Its own states are the last elongation and the hysteretic state there.

    The state depends on the path of the elongation and not on its speed, so it is carried along the path
    (Runge-Kutta), also when the motor jumps.
    """

    kind = "bouc_wen"
    flexible = True
    blocks = ("wire",)
    parameters = BOUC_WEN_PARAMETERS
    equation = "F = k d + alpha z; dz/dt = A dd - beta |dd| |z|^(n-1) z - gamma dd |z|^n, d = u - x"
    depends_on = ("x", "u")
    words = (
        "the wire of {actuator} is hysteretic (Bouc-Wen): its force depends on where its elongation last "
        "turned; in small motions it adds a stiffness of {alpha}"
    )
    noun = BOUC_WEN_NOUN
    experiment = BOUC_WEN_EXPERIMENT
    possible = BOUC_WEN_POSSIBLE
    secondary = BOUC_WEN_SECONDARY
    powers = BOUC_WEN_POWERS
    along = BOUC_WEN_ALONG
    plainer = (Plainer("pulley_friction", lambda p: {"force": 2.0 * yield_force(p)}),)
    states = 2
    order = 5
    path = (1.0, -1.0)
    kinked = True
    cost = 10
    rank = 60

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Loops of a hysteretic wire."""
        yield from loops(signals, rms(signals.elongation))

    @staticmethod
    def force(u, x, v, k, f, z, p):  # type: ignore[no-untyped-def]
        return f + p[0] * z[1]

    @staticmethod
    def settle(u, x, k, z, p):  # type: ignore[no-untyped-def]
        path = u - x - z[0]
        if path == 0.0:
            return
        bend = (abs(p[2]) + abs(p[3])) * abs(z[1]) ** (p[4] - 1.0) * abs(path)
        steps = 1 if bend < 0.03 else 4  # one is then right to 1e-9 of its change
        h = path / steps
        side = 1.0 if h > 0.0 else -1.0
        for _ in range(steps):
            total = 0.0
            slope = 0.0
            for stage in range(4):
                y = z[1] + h * slope * (0.0 if stage == 0 else 1.0 if stage == 3 else 0.5)
                slope = p[1] - abs(y) ** (p[4] - 1.0) * (p[2] * side * y + p[3] * abs(y))
                total += slope * (1.0 if stage == 0 or stage == 3 else 2.0)
            z[1] += h * total / 6.0
        z[0] = u - x

    @staticmethod
    def initial(u, x, p):  # type: ignore[no-untyped-def]
        return (u - x, 0.0)


@register
class Slack(WireLaw):
    """Wire that cannot push: its tension, pretension plus F, never falls below zero."""

    kind = "slack"
    blocks = ("wire",)
    parameters = {
        "pretension": EffectParameter("N", "tension at F = 0; overrides the actuator's", minimum=0.0)
    }
    equation = "F >= -F_0"
    depends_on = ("x", "u")
    words = "the wire of {actuator} goes slack: its pretension is only {pretension}"
    noun = "a slack wire"
    experiment = "Repeat the test with more pretension."
    order = 9
    changes = "pretension"
    kinked = True
    rank = 20

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Tensions that are lost for 0.5 to 30 % of the time."""
        for share in (0.005, 0.02, 0.06, 0.15, 0.3):
            level = float(np.quantile(-signals.force, 1.0 - share))
            if level > 0.0:
                yield Guess({"pretension": level}, scales={"pretension": 0.2 * signals.size})

    @staticmethod
    def force(u, x, v, k, f, z, p):  # type: ignore[no-untyped-def]
        return max(f, -p[0])
