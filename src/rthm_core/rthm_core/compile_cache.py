"""Where compiled functions are kept, and how processes share them.

Numba's own cache looks at one file only: a cached caller can keep an old callee of another module. The cache
folder is therefore keyed by a hash of all sources of this package. Nor does it know that another process is
compiling the same function just now, as the nodes of a test do at their first start; here the others wait
for the first one and read what it made.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.runtime import rtsys

from rthm_core.errors import InputError
from rthm_core.private_folder import NotPrivateError, make_private

if TYPE_CHECKING:
    from filelock import FileLock

_NOT_COMPILED, _COMPILED_ALL_THE_SAME = ("ros", "spec", "effects"), "laws.py"
"""Folders of this package of which nothing is part of a kernel, and the one file in them that is: what laws
leave as it is. The laws themselves are kept one by one (`law_code`).
"""

COMPILED_WITHIN = 300.0
"""How long to wait for another process before compiling the same as well, s."""


def _source_hash() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    package = Path(__file__).parent
    for source in sorted(package.rglob("*.py")):
        if source.parent.name in _NOT_COMPILED and source.name != _COMPILED_ALL_THE_SAME:
            continue
        digest.update(str(source.relative_to(package)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Where the kernels of these sources are kept: see `private_folder`."""
    return private_folder(_source_hash())


def private_folder(name: str) -> Path:
    """Where compiled code is kept, private to this user: ``RTHM_CACHE_DIR``, the user's cache, or a temporary
    folder when neither can be written.

    Parameters
    ----------
    name
        Of the last folder on the way.

    Raises
    ------
    InputError
        If ``RTHM_CACHE_DIR`` or the temporary folder can be written by others.
    """
    chosen = os.environ.get("RTHM_CACHE_DIR")
    base = chosen or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    folder = Path(base) / "rthm" / "compiled" / name
    try:
        make_private(folder)
        if os.access(folder, os.W_OK):
            return folder
    except NotPrivateError as error:
        if chosen:
            raise _refused(folder, error) from error
    except OSError:
        pass
    return _temporary_folder(name)


def _temporary_folder(name: str) -> Path:
    folder = Path(tempfile.gettempdir()) / f"rthm-compiled-{os.getuid()}" / name
    try:
        make_private(folder.parent)
        make_private(folder)
    except NotPrivateError as error:
        raise _refused(folder, error) from error
    return folder


def _refused(folder: Path, error: NotPrivateError) -> InputError:
    return InputError(
        f"Compiled code cannot be kept in {folder}, as {error}, and who can write it decides what is"
        " executed; set RTHM_CACHE_DIR to a folder that is yours alone."
    )


class _Loading(CompileResultCacheImpl):  # type: ignore[misc]
    """How compiled code is made of what the disk has."""

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """As numba does it, but ready for counted references only if there are any in this code."""
        _, _, codes = payload[0]
        if any(b"NRT_" in code for code in codes):
            rtsys.initialize(target_context)
        return super().rebuild(target_context, payload)


class SharedCache(FunctionCache):  # type: ignore[misc]
    """Compiled versions of one function, which of several processes only one compiles.

    A process that finds none holds a lock of this function until it has saved what it compiled. Functions
    call each other in one direction, so no two processes wait for each other.

    Parameters
    ----------
    function
        The function in Python.
    """

    _impl_class = _Loading

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Compiled code from the disk, or None, and then nobody else compiles it until `save_overload`."""
        found = self._from_disk(sig, target_context)
        if found is not None:
            return found
        with suppress(OSError, NotImplementedError):
            self._lock.acquire()
        found = self._from_disk(sig, target_context)
        if found is not None:
            self._lock.release()
        return found

    def _from_disk(self, sig: Any, target_context: Any) -> Any:
        """As numba loads it, but without first importing what only compiling needs, a third of a start."""
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep compiled code and let others have it."""
        try:
            super().save_overload(sig, data)
        finally:
            self._lock.release()

    @cached_property
    def _lock(self) -> FileLock:
        """Held by the process that compiles this function; imported only where something is compiled."""
        from filelock import FileLock

        self._impl.locator.ensure_cache_path()
        return FileLock(Path(self.cache_path) / f"{self._impl.filename_base}.lock", timeout=COMPILED_WITHIN)
