"""What a run is to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from rthm_bringup.run import roles
from rthm_bringup.run.environment import Network
from rthm_core.errors import InputError
from rthm_core.limits import require_limits
from rthm_core.spec import Spec, write_spec


@dataclass(frozen=True)
class Plan:
    """A run before it begins.

    Parameters
    ----------
    spec
        The test; every section that the loop needs must be there.
    out
        Folder for bag, report and logs.
    duration
        Length of the test in s; 0: until Ctrl-C.
    network
        Who can see the nodes.
    virtual
        Simulated time in lock step instead of real time.
    external
        Parts that somebody else starts.
    priority
        Real-time priority that the nodes of the loop ask for; None: their default.
    patience
        How long to wait for the external parts, s.
    any_clock
        Whether clocks of other hosts may differ by more than `limits.clock`; the analysis corrects for it.
    hardware
        Whether the plant is a real machine.
    dry_run
        Whether no command is sent to the motors.
    heartbeat
        Whether an operator's heartbeat has to be there.
    compose
        Whether the numerical substructure and the controller share a process.
    excitation
        Size of a motion that measures the rig instead of a test, m; 0: none.
    """

    spec: Spec
    out: Path
    duration: float
    network: Network
    virtual: bool = False
    external: frozenset[str] = field(default_factory=frozenset)
    priority: int | None = None
    patience: float = 300.0
    any_clock: bool = False
    hardware: bool = False
    dry_run: bool = False
    heartbeat: bool = False
    compose: bool = False
    excitation: float = 0.0

    def __post_init__(self) -> None:
        roles.check(self.external)
        if not 0.0 <= self.duration <= 1e6:
            raise InputError(
                f"The duration is {self.duration:g} s, but must be from 0 to 1e6 s; choose another one."
            )
        if self.virtual and not self.duration:
            raise InputError("A run with --virtual needs an end, but its duration is 0; give --duration.")
        if self.virtual and self.external:
            raise InputError(
                f"A run with --virtual has only simulated parts, but {', '.join(sorted(self.external))} "
                "is external; leave out --virtual or --external."
            )
        if self.compose and (self.virtual or self.external.intersection(roles.COMPOSED)):
            raise InputError(
                "--compose works only in real time with both parts on this host; drop it, or drop "
                "--virtual/--external."
            )
        missing = [
            name
            for name in ("plant", "numerical", "interface", "actuator", "timing")
            if not getattr(self.spec, name)
        ]
        if missing:
            raise InputError(f"The spec has no section {missing[0]}, and a run needs it; add it.")
        if self.hardware:
            require_limits(self.spec)

    @property
    def bag(self) -> Path:
        """Folder of the recording."""
        return self.out / "bag"

    @property
    def report(self) -> Path:
        """Page about the run."""
        return self.out / "report.html"

    @property
    def log(self) -> Path:
        """Folder with what the processes say."""
        return self.out / "log"

    @property
    def spec_file(self) -> Path:
        """The spec, fully expanded, as the nodes get it."""
        return self.out / "spec.yaml"

    def lay_out(self) -> None:
        """Make the folders and write the spec; InputError where that is not possible."""
        if self.bag.exists() and any(self.bag.iterdir()):
            raise InputError(
                f"{self.bag} has a recording already, and none is overwritten; name another --out."
            )
        try:
            self.log.mkdir(parents=True, exist_ok=True)
            self.spec_file.write_text(write_spec(self.spec))
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError(f"{self.out} cannot be written ({reason}); name another --out.") from error


def new_folder(base: Path = Path("out")) -> Path:
    """Name for a new run: ``out/2025-01-31_12-30-00``."""
    name = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    taken = [base / name, *(base / f"{name}_{k}" for k in range(2, 100))]
    return next(path for path in taken if not path.exists())
