"""The event engine in C: compiled on the spot, called through ctypes."""

from __future__ import annotations

import ctypes
import os
import shutil
import struct
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.spec import Spec

SOURCE = Path(__file__).with_name("event_engine.c")
COLUMNS = 6
"""x1, v1, x2, v2, F_d in use, F."""


class NoCompilerError(Exception):
    """There is no C compiler on this machine."""


def compiler() -> str:
    """Command of the system's C compiler."""
    for name in (os.environ.get("CC", ""), "cc", "gcc", "clang"):
        if name and shutil.which(name):
            return name
    raise NoCompilerError("no C compiler (cc, gcc or clang) was found; install one to measure against it.")


def build(source: Path = SOURCE, **defined: int) -> ctypes.CDLL:
    """Compile a C file, with some names defined, into a temporary folder and load it."""
    folder = tempfile.mkdtemp(prefix="rthm-benchmark-")
    target = Path(folder) / "engine.so"
    options = [
        "-O3",
        "-march=native",
        "-shared",
        "-fPIC",
        *(f"-D{name}={value}" for name, value in defined.items()),
    ]
    subprocess.run([compiler(), *options, str(source), "-o", str(target), "-lm"], check=True)
    return ctypes.CDLL(str(target))


def packed(spec: Spec) -> bytes:
    """Numbers of a two-mass loop as the C engine reads them."""
    p, face, q, t = spec.plant, spec.interface, spec.numerical, spec.timing
    assert face is not None and q is not None and t is not None
    numbers = [p.mass, p.damping, p.stiffness, spec.k_tot, q.mass, face.damping, face.stiffness]
    numbers += [q.damping, q.stiffness, p.initial_position, p.initial_velocity]
    numbers += [q.initial_position, q.initial_velocity]
    times = [t.ns(name) for name in ("td1", "td2", "td3", "tau1", "tau2", "tau3", "tau4")]
    return struct.pack("13d7q", *(one[0] for one in numbers), *times)


def event_engine(spec: Spec, end: int, step: int) -> tuple[Callable[[], object], Floats]:
    """A call that simulates up to `end` ns, and the rows (N, 6) that it fills, every `step` ns."""
    function = build().run
    function.argtypes = [ctypes.c_char_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p]
    rows, loop = np.zeros((end // step + 1, COLUMNS)), packed(spec)
    return lambda: function(loop, end, step, rows.ctypes.data), rows
