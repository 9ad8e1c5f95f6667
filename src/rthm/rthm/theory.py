"""What a loop does in theory: its stability, its frequency response."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rthm.optional import needed
from rthm.results import Column, Result, blank
from rthm.specs import Named, load
from rthm_analysis import response as responses
from rthm_analysis import stability as stabilities
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Stability(Result, stabilities.Stability):
    """Stability of a loop; its fields are those of `rthm_analysis.stability.Stability`.

    ``stable``, ``spectral_radius`` over ``hyperperiod`` (s), ``modes``, and ``limits`` by delay and period.
    """

    def columns(self) -> dict[str, Column]:
        """A row for every mode, the one that fades most slowly first."""
        return {
            "frequency": Column(np.array([mode.frequency for mode in self.modes]), "rad/s"),
            "damping_ratio": Column(np.array([mode.damping_ratio for mode in self.modes]), "1"),
        }

    def plot(self, *names: str) -> Figure:
        """Draw the damping ratio of every mode over its frequency; below zero it grows.

        Returns
        -------
        matplotlib.figure.Figure
        """
        figure, modes = blank(1), self.columns()
        figure.axes[0].plot(modes["frequency"].values, modes["damping_ratio"].values, "o")
        figure.axes[0].axhline(0.0, color="#999999", linewidth=0.8)
        figure.axes[0].set(xscale="log", xlabel="frequency, rad/s", ylabel="damping ratio")
        return figure

    def summary(self) -> list[tuple[str, ...]]:
        """Whether it is stable, and a row for every mode."""
        head = "stable" if self.stable else "not stable"
        return [(head, f"spectral radius {self.spectral_radius:.6g}"), *self.rows()]


class Response(Result, responses.Response):
    """Frequency response from loads to positions.

    Attributes
    ----------
    omega : (W,) array
        rad/s.
    dofs : tuple of N str
        Inputs and outputs.
    ways : dict of (W, N, N) complex arrays
        ``ideal``, ``delays``, ``delays_and_holds``, ``taylor``, ``sampled``: ``[frequency, output, input]``,
        m/N.
    stable : bool
        Whether the sampled loop is.
    margins : tuple of Margins
        Gain, phase and delay margin at the command of each motor.
    """

    def columns(self) -> dict[str, Column]:
        """Frequency, and amplitude and phase of each way from a load on one dof to the motion of another."""
        found = {"omega": Column(self.omega, "rad/s")}
        for way, values in self.ways.items():
            for o, output in enumerate(self.dofs):
                for i, load_on in enumerate(self.dofs):
                    name, one = f"{way}.{output}/{load_on}", values[:, o, i]
                    found[f"{name}.amplitude"] = Column(np.abs(one), "m/N")
                    found[f"{name}.phase"] = Column(np.unwrap(np.angle(one)), "rad")
        return found

    def shown(self) -> list[str]:
        """Of the first dof to a load on itself, every way."""
        pair = f".{self.dofs[0]}/{self.dofs[0]}."
        return [name for name in self.columns() if pair in name]

    def to_control(self, way: str = "sampled") -> Any:
        """Return one way as a ``FrequencyResponseData`` of python-control, (N outputs, N inputs).

        Raises
        ------
        InputError
            If there is no such way, or python-control is not installed.
        """
        if way not in self.ways:
            raise InputError(f"there is no way {way!r}, only {', '.join(self.ways)}; choose one of them.")
        values, dofs = np.moveaxis(self.ways[way], 0, 2), [dof.replace(".", "_") for dof in self.dofs]
        control = needed("control", "to_control")
        return control.frd(values, self.omega, inputs=[f"w_{dof}" for dof in dofs], outputs=dofs)

    @classmethod
    def from_control(cls, found: Any, way: str = "measured") -> Response:
        """Return a square ``FrequencyResponseData`` of python-control (N outputs, N inputs) as a response.

        Raises
        ------
        InputError
            If it does not have as many inputs as outputs.
        """
        values = np.moveaxis(np.asarray(found.frdata, dtype=complex), 2, 0)
        outputs, inputs = values.shape[1:]
        if outputs != inputs:
            raise InputError(
                f"the response has {outputs} outputs and {inputs} inputs, but must have a load and a motion "
                "for every dof; leave the others out."
            )
        omega = np.asarray(found.omega, dtype=float)
        return cls(omega, tuple(found.output_labels), {way: values}, True, 0.0, ())


def stability(spec: Named, *, limits: bool = True) -> Stability:
    """Tell whether a loop is stable, its modes, and how far every delay is from the edge.

    Parameters
    ----------
    spec : str, Path or Spec
        Name of a shipped spec, path, or spec, of a loop; what is not linear in it is left out.
    limits : bool
        Whether every crossing is searched.

    Returns
    -------
    Stability

    Raises
    ------
    InputError
        If the spec is no loop.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.stability("paper", limits=False)
    >>> found.stable, round(found.spectral_radius, 4)
    (True, 0.9989)
    """
    return Stability.of(stabilities.stability(load(spec), limits=limits))


def response(spec: Named, omega: npt.ArrayLike) -> Response:
    """Frequency response of a loop: ideal, with delays, with holds, to first order, and exactly sampled.

    Parameters
    ----------
    spec : str, Path or Spec
        Name of a shipped spec, path, or spec, of a loop; what is not linear in it is left out.
    omega : (W,) array
        Frequencies, rad/s, positive.

    Returns
    -------
    Response

    Raises
    ------
    InputError
        If the spec is no loop, or a frequency is not positive.

    Examples
    --------
    >>> import numpy as np, rthm
    >>> found = rthm.response("paper", np.geomspace(1.0, 10.0, 50))
    >>> found.ways["sampled"].shape
    (50, 2, 2)
    """
    return Response.of(responses.response(load(spec), np.asarray(omega, dtype=float)))
