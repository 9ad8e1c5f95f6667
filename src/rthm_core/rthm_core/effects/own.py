"""Effects of a user's own: files and modules that declare kinds, and what installed packages bring along.

To load a file is to execute it. So only what somebody names is loaded: a spec file that is read from its
path, an option of a verb, the parameters of a node. A spec in a recording names its files, too, and they are
not loaded: who wants them names them himself.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from rthm_core.effects.laws import MOST_PARAMETERS, PlantLaw, WireLaw
from rthm_core.effects.registry import declared, forget
from rthm_core.errors import InputError, shown
from rthm_core.quantity import Text

_LOADED: dict[str, bytes] = {}
"""Files, by path, and modules, by name, that were loaded, with the digest of their sources."""

KEY = "effects_from"
"""Key of a spec that lists files and modules."""

GROUP = "rthm.effects"
"""Entry points by which an installed package announces modules that declare kinds."""


def load_effects(sources: Iterable[str | Path], folder: Path | None = None) -> tuple[str, ...]:
    """Execute files or modules that declare kinds of effects, each once.

    Parameters
    ----------
    sources
        Paths of Python files, or names of modules.
    folder
        From where relative paths count; the working directory when absent.

    Returns
    -------
    tuple of str
        Absolute paths and names of modules, for ``effects_from`` in a spec.

    Raises
    ------
    InputError
        When one is not there, fails, declares no kind, or one that is there already; or when a file was
        changed after it was loaded.
    """
    return tuple(_load(placed(str(source), folder)) for source in sources)


def placed(source: str, folder: Path | None = None) -> str:
    """A source as a spec names it everywhere: the absolute path of a file, the name of a module."""
    if not source.endswith(".py"):
        return source
    return str(((folder or Path()).absolute() / Path(source).expanduser()).resolve())


def not_loaded(sources: Iterable[object]) -> tuple[str, ...]:
    """Those of some sources that were not loaded."""
    return tuple(str(one) for one in sources if str(one) not in _LOADED)


def _load(source: str) -> str:
    known = _LOADED.get(source)
    digest = _digest(source)
    if known is not None:
        if known != digest:
            raise InputError(f"{source} was changed after it was loaded; start Python again.")
        return source
    with _declaring(source):
        _execute(source)
    _LOADED[source] = digest
    return source


@cache
def load_installed() -> None:
    """Import what installed packages announce in the group of entry points `GROUP`, once.

    Raises
    ------
    InputError
        When one of them fails, or declares what nothing would compute with.
    """
    for found in entry_points(group=GROUP):
        with _declaring(f"{found.dist.name if found.dist else 'a package'} ({found.value})", named=False):
            found.load()


@contextmanager
def _declaring(source: str, *, named: bool = True) -> Iterator[None]:
    """Check the kinds that are declared meanwhile, and take them out again if anything is wrong; where a
    source was `named` for them there must be some.
    """
    before = set(declared())
    try:
        yield
        found = [one for one in declared() if one not in before]
        if not found and named and source not in sys.modules:
            raise InputError(
                f"{source} declares no kind of effect; decorate a class of PlantLaw with register."
            )
        for law in found:
            _check_law(source, law)
    except Exception as error:
        forget(one for one in declared() if one not in before)
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{source} cannot be loaded as effects ({type(error).__name__}: {error}), but must "
            "be the path of a Python file (.py) or the name of a module; correct it."
        ) from error


def _digest(source: str) -> bytes:
    """Of the content of a file; a module's is that of its name."""
    try:
        content = Path(source).read_bytes() if source.endswith(".py") else source.encode()
    except OSError as error:
        raise InputError(
            f"{KEY} names {shown(source)}, which cannot be read ({error.strerror}); give the path of a "
            "Python file or the name of a module."
        ) from None
    return hashlib.sha256(content).digest()


def _execute(source: str) -> None:
    """Execute a file or import a module."""
    if not source.endswith(".py"):
        importlib.import_module(source)
        return
    path = Path(source)
    name = f"{path.stem}_{hashlib.sha256(source.encode()).hexdigest()[:8]}"
    found = importlib.util.spec_from_file_location(name, path)
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[name] = module
    found.loader.exec_module(module)


def _check_law(source: str, law: Any) -> None:
    places = {"plant": PlantLaw, "wire": WireLaw}
    if not all(issubclass(law, places.get(block, ())) for block in law.blocks):
        raise InputError(
            f"{source} declares {law.kind} for {', '.join(law.blocks)}, but effects of one's own are a "
            "PlantLaw for plant or a WireLaw for wire; derive it from one of these."
        )
    most = MOST_PARAMETERS - ("load" in law.depends_on)
    if len(law.parameters) > most or any(isinstance(p, Text) for p in law.parameters.values()):
        raise InputError(
            f"{source} declares {law.kind} with the parameters {', '.join(law.parameters)}, but a law may "
            f"have up to {most} numbers; leave some out."
        )
