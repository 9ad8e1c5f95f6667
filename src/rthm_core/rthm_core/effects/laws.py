"""What a law of force is: the interface between an effect and everything that computes with it.

A law is a handful of pure functions of numbers, written once in plain Python. The simulator compiles them,
the plant node runs the same compiled code, and the diagnosis fits their parameters.

Symbols: ``x`` (m) and ``v`` (m/s) motion of the dof, ``z`` the law's own states, ``t`` (s) time since the
start of the test, ``p`` the parameters in the order of their declaration, ``mode`` the mode of the law.

**Modes.** Friction, stops and hysteresis are smooth only between switching points. The integrator freezes
``mode`` during a step and ends the step where it changes, so that no step crosses a kink. ``partition`` says
in which variable the modes meet:

* ``"none"``: one mode, 0;
* ``"position"``: mode k lies between ``thresholds(p)[k - 1]`` and ``thresholds(p)[k]``;
* ``"time"``: likewise between instants, in s;
* ``"velocity"``: mode +1 for v > 0, -1 for v < 0;
* ``"friction"``: as velocity, and 0 where the dof sticks; it breaks away when the force that holds it exceeds
``breakaway(p)``.
"""

from __future__ import annotations

from typing import ClassVar

from rthm_core.effects.declaration import Effect
from rthm_core.effects.possible import Values

Parameters = tuple[float, ...]

MOST_PARAMETERS = 8
"""Numbers that a law may have; one less if it depends on the known load."""

LOAD = MOST_PARAMETERS - 1
"""Where in its parameters a law that depends on ``load`` finds the known load on its dof, N."""


class PlantLaw(Effect):
    """Force on one dof of the plant, in N, + along +x."""

    partition: ClassVar[str] = "none"
    constant: ClassVar[bool] = False
    """Whether the force depends on the mode alone."""

    @staticmethod
    def force(x: float, v: float, z: list[float], t: float, p: list[float], mode: int) -> float:
        """Force on the dof, in N."""
        raise NotImplementedError

    @staticmethod
    def inertia(x: float, v: float, z: list[float], t: float, p: list[float], mode: int) -> float:
        """Mass that moves with the dof beside the plant's own, in kg: a force ``-inertia a`` beside `force`.

        What joins the dof or leaves it does so with the dof's velocity, so that it adds no thrust. Where it
        depends on `x`, `force` has the rest of the kinetic energy's part, ``-inertia' v^2 / 2``.
        """
        return 0.0

    @staticmethod
    def coupling(x: float, y: float, p: list[float]) -> float:
        """Mass m, in kg, that couples the dof at `x` with that at `y`, to which it is relative: their kinetic
        energy ``m v w`` beside all other, with the velocities v and w.

        The forces follow from it and its slopes (Lagrange): ``-m a_y - coupling_by_y w^2`` on the dof, and
        ``-m a_x - coupling_by_x v^2`` on the other. `force` acts beside them.
        """
        return 0.0

    @staticmethod
    def coupling_by_x(x: float, y: float, p: list[float]) -> float:
        """Slope of `coupling` over `x`, in kg/m."""
        return 0.0

    @staticmethod
    def coupling_by_y(x: float, y: float, p: list[float]) -> float:
        """Slope of `coupling` over `y`, in kg/m."""
        return 0.0

    @staticmethod
    def rate(
        x: float, v: float, z: list[float], t: float, p: list[float], mode: int, dz: list[float]
    ) -> None:
        """Write the time derivative of the own states into `dz`."""

    @staticmethod
    def thresholds(p: Parameters) -> tuple[float, ...]:
        """Positions, or instants, at which the modes meet, ascending; at most two."""
        return ()

    @staticmethod
    def breakaway(p: Parameters) -> float:
        """Largest force that holds the dof at rest, in N."""
        return 0.0

    @staticmethod
    def excitation(p: Parameters) -> tuple[float, float, float, float] | None:
        """Constant (N), amplitude (N), frequency (rad/s) and phase of a law that depends on time alone; None
        for all others.
        """
        return None

    @staticmethod
    def steepest(p: Values) -> tuple[float, float]:
        """Slopes of the force over x (N/m) and v (N s/m) by which it can make the motion stiff, given the
        parameters by name: that called stiffness, if there is one, unless a law says otherwise.
        """
        return float(p.get("stiffness", 0.0)), 0.0

    @staticmethod
    def initial(x: float, p: Parameters) -> tuple[float, ...]:
        """Own states in steady state, the dof at rest at `x`."""
        return ()


def has_inertia(law: type[Effect]) -> bool:
    """Whether something moves with a dof by a law, so that its force depends on the acceleration."""
    return issubclass(law, PlantLaw) and law.inertia is not PlantLaw.inertia


def has_coupling(law: type[Effect]) -> bool:
    """Whether a law couples the accelerations of two dofs."""
    return issubclass(law, PlantLaw) and law.coupling is not PlantLaw.coupling


class WireLaw(Effect):
    """What a wire does beside ``k (u - x)``.

    Wire laws of one actuator act one after the other: each gets the drive-side position `u` and the force `f`
    that the laws before it left
    and gives the force that it leaves. ``order`` sorts them from the motor to the plant.
    """

    order: ClassVar[int] = 0
    path: ClassVar[tuple[float, float]] = (0.0, 0.0)
    """Shares of `u` and of `x` in what `settle` follows; a step of the simulation ends where that turns."""

    @staticmethod
    def settle(u: float, x: float, k: float, z: list[float], p: list[float]) -> None:
        """Bring own states that depend on the path and not on time up to the present `u` and `x`, in place.

        The path since the last call must not have turned. The other functions see settled states.
        """

    @staticmethod
    def drive(u: float, z: list[float], p: list[float]) -> float:
        """Drive-side position as the laws after this one and the wire feel it, in m."""
        return u

    @staticmethod
    def force(u: float, x: float, v: float, k: float, f: float, z: list[float], p: list[float]) -> float:
        """Wire force, in N; `f` is the force without this law."""
        return f

    @staticmethod
    def rate(u: float, x: float, v: float, k: float, z: list[float], p: list[float], dz: list[float]) -> None:
        """Write the time derivative of the other own states into `dz`."""

    @staticmethod
    def initial(u: float, x: float, p: Parameters) -> tuple[float, ...]:
        """Own states in steady state, motor and dof at rest at `u` and `x`."""
        return ()
