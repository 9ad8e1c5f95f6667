"""Recordings: read one, count its energy, measure its timing, find out what its model lacks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from rthm.diagnoses import Diagnosis
from rthm.results import Column, Result
from rthm.specs import Named, load
from rthm.timings import Timing
from rthm_analysis import recording
from rthm_analysis.energy import EnergyResult, energy_of
from rthm_analysis.timing import timing_of
from rthm_core.effects import load_effects
from rthm_core.errors import InputError

Recorded = str | Path | recording.Recording
"""What names a recording: the path of a bag, or a recording that was read before."""

QUANTITIES = {"position": "m", "velocity": "m/s", "acceleration": "m/s^2", "effort": "N"}
"""What is recorded of a plant, and its unit."""


class Recording(Result, recording.Recording):
    """What a bag says about one test; its fields are those of `rthm_analysis.recording.Recording`.

    ``tables["plant/state"].position`` (n, k) has the samples of a topic, ``links["tau1"]`` which sample was
    used when, ``spec`` what the test was.
    """

    def columns(self) -> dict[str, Column]:
        """Samples of ``plant/state`` and accelerations at them; those of other topics are in `tables`."""
        table = self.plant
        found = {"t": Column(self.seconds(table.stamp_ns), "s")}
        for kind, unit in QUANTITIES.items():
            known = self.accelerations(table.names) if kind == "acceleration" else getattr(table, kind)
            for name, values in zip(table.names, known.T, strict=True):
                if np.isfinite(values).any():
                    found[f"{name}.{kind}"] = Column(values, unit)
        return found


class Energy(Result, EnergyResult):
    """Energies of a recorded test; work is + when introduced.

    Attributes
    ----------
    t : (n,) array
        s since the start of the test.
    work : dict of (n,) arrays
        ``E_num``, ``E_ff``, ``E_fx``, ``E_damping``, ``E_load``, ``E_effects``, J; NaN: cannot be told.
    total, error, balance_error : (n,) arrays
        E_total; what delays, holds and actuator brought in; and the check, J.
    """

    def columns(self) -> dict[str, Column]:
        """Time, work by term, its sum over the errors of the loop, total, balance error."""
        sums = {"E_err": self.error, "E_total": self.total, "balance_error": self.balance_error}
        work = {name: Column(values, "J") for name, values in (self.work | sums).items()}
        return {"t": Column(self.t, "s"), **work}


def read(bag: Recorded, effects: Iterable[str | Path] = ()) -> Recording:
    """Read the recording of a test.

    Parameters
    ----------
    bag : str or Path
        Folder or file of a rosbag2 recording, whoever recorded it.
    effects : iterable of str or Path
        Python files, or modules, that declare kinds of effects which the spec in the bag has. They are
        executed; nothing that the bag itself names is.

    Returns
    -------
    Recording

    Raises
    ------
    InputError
        If there is no recording of a test.

    Examples
    --------
    >>> import rthm
    >>> rig = rthm.read("rig/bag")
    >>> f"{rig.duration:.0f} s of {', '.join(rig.plant.names)}"
    '10 s of x1, a1'
    """
    load_effects(effects)
    found = bag if isinstance(bag, recording.Recording) else recording.read_recording(bag)
    return Recording.of(found)


def import_table(
    file: str | Path,
    bag: str | Path,
    columns: Mapping[str, str],
    spec: Named | None = None,
    *,
    units: Mapping[str, str] | None = None,
    time: str | None = None,
    rate: float | None = None,
) -> Recording:
    """Make a bag of a table that another tool has written, and read it.

    Parameters
    ----------
    file : str or Path
        CSV, MAT or Parquet.
    bag : str or Path
        The folder of the bag; it must not exist, or be empty.
    columns : mapping of str to str
        Which column has what: ``{"position:x1": "Displacement"}``. Roles are ``position``, ``velocity``,
        ``acceleration`` and ``load`` of a dof, ``force`` and ``motor`` of an actuator.
    spec : str, Path or Spec, optional
        The nominal model; it goes into the bag.
    units : mapping of str to str, optional
        Unit by role where the file says none or a wrong one, as ``{"position": "mm"}``, or a factor to SI.
    time : str, optional
        The column with the time; ``t`` or ``time``, whatever its unit, when absent.
    rate : float, optional
        Samples per second, where no column has the time.

    Returns
    -------
    Recording

    Raises
    ------
    InputError
        If the file cannot be read, a column, role or unit is not known, or the bag exists.

    Examples
    --------
    >>> import numpy as np, rthm
    >>> t = np.arange(0.0, 5.0, 0.005)
    >>> table = np.column_stack([t, 500.0 * np.cos(3.0 * t)])
    >>> np.savetxt("decay.csv", table, delimiter=",", header="t [s],Displacement [mm]", comments="")
    >>> rig = rthm.import_table("decay.csv", "decay", {"position:x1": "Displacement"})
    >>> f"{rig.plant.position[0, 0]:.1f} m"
    '0.5 m'
    """
    from rthm_analysis.exchange import import_files, wanted

    nominal = None if spec is None else load(spec)
    maps = [f"{role}={column}" for role, column in columns.items()]
    of = [f"{role}={unit}" for role, unit in (units or {}).items()]
    found = import_files([str(file)], Path(bag), wanted(maps, of, time, rate, nominal), nominal)
    if len(found) > 1:
        raise InputError(
            f"{file} has {len(found)} recordings, and `import_table` makes one bag; "
            "rthm import makes one for each."
        )
    return read(found[0].bag)


def energy(bag: Recorded, spec: Named | None = None) -> Energy:
    """Count where the energy of a recorded test came from.

    Parameters
    ----------
    bag : str, Path or Recording
        The recording.
    spec : str, Path or Spec, optional
        What the test was; the spec in the recording when absent.

    Returns
    -------
    Energy

    Raises
    ------
    InputError
        If there is no spec, or the recording does not have the plant's dofs.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.energy("rig/bag")
    >>> list(found.work)
    ['E_num', 'E_ff', 'E_fx', 'E_damping', 'E_load', 'E_effects']
    """
    return Energy.of(energy_of(read(bag), None if spec is None else load(spec)))


def timing(bag: Recorded, spec: Named | None = None) -> Timing:
    """Measure the delays and clocks of a recorded test.

    Parameters
    ----------
    bag : str, Path or Recording
        The recording.
    spec : str, Path or Spec, optional
        What the test was to be; the spec in the recording when absent.

    Returns
    -------
    Timing

    Raises
    ------
    InputError
        If there is no recording of a test.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.timing("rig/bag")
    >>> found.missed, found.links["tau1"].lost
    (0, 0)
    """
    recorded = read(bag)
    return Timing.of(timing_of(recorded, recorded.spec if spec is None else load(spec)))


def diagnose(
    bag: Recorded | Sequence[Recorded], spec: Named | None = None, effects: Iterable[str | Path] = ()
) -> Diagnosis:
    """Find out where a recording and its simulation differ, and which physics was left out.

    Parameters
    ----------
    bag : str, Path or Recording, or a sequence of these
        The recording, or several of one rig: the last confirms what the others show.
    spec : str, Path or Spec, optional
        The nominal model; the spec in each recording when absent.
    effects : iterable of str or Path
        Python files, or modules, that declare further kinds of effects to look for. They are executed.

    Returns
    -------
    Diagnosis

    Raises
    ------
    InputError
        If names or sizes of spec and recording do not fit, the recording is too short to say anything, or
        several are not of one rig.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.diagnose("rig/bag", "paper")
    >>> found.verdict, [one.kind for one in found.physics]
    ('explained', ['coulomb_friction'])
    """
    from rthm_analysis import diagnosis

    bags = bag if isinstance(bag, Sequence) and not isinstance(bag, str) else [bag]
    recorded = [read(one, effects) for one in bags]
    specs = [recording.nominal_spec(one, spec, effects) for one in recorded]
    return Diagnosis.of(diagnosis.diagnose_together(recorded, specs))
