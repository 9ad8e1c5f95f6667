"""Read a spec from a ROS 2 parameter file or from its text."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from rthm_core.effects.own import KEY, load_effects, placed
from rthm_core.errors import InputError, nearest, printable, shown, suggestion
from rthm_core.spec.building import spec_from_parameters
from rthm_core.spec.changes import with_effects_from
from rthm_core.spec.schema import Spec
from rthm_core.spec.yaml_text import parameters_in

LARGEST_FILE = 4_000_000
"""Bytes; a larger file is no spec."""


def read_spec(source: str | Path) -> Spec:
    """Read a spec.

    Parameters
    ----------
    source
        Path of a file, or YAML text (what has a line break, or a ``: `` and names no file). In a file, the
        paths of loads and of ``effects_from`` count from the file's folder, and what the latter names is
        executed. Text executes nothing.

    Raises
    ------
    InputError
        One sentence: what is wrong, what is allowed, the way out.
    """
    path = _as_path(source)
    if path is None:
        return spec_from_parameters(parameters_in(str(source)))
    try:
        given = parameters_in(_text_of(path))
        given = {name: _from_folder(name, value, path) for name, value in given.items()}
        return spec_with_own_effects(given)
    except InputError as error:
        raise InputError(f"{printable(str(path))}: {error}") from None


def spec_with_own_effects(given: Mapping[str, Any], besides: Collection[str] = ()) -> Spec:
    """Spec that parameters describe, as `spec_from_parameters`, once the files are loaded (executed) in which
    it says that its effects are declared.
    """
    named = given.get(KEY)
    if isinstance(named, list | tuple) and all(isinstance(one, str) for one in named):
        load_effects(named)
    return spec_from_parameters(given, besides)


def _as_path(source: str | Path) -> Path | None:
    if isinstance(source, Path):
        return source
    if not isinstance(source, str):
        raise InputError(f"a spec is {shown(source)}, but must be a path or YAML text; give one of the two.")
    if "\n" in source or "\0" in source or not source.strip():
        return None
    return None if ": " in source and not _exists(Path(source)) else Path(source)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def _text_of(path: Path) -> str:
    """Content of a spec file."""
    try:
        if path.is_dir():
            raise InputError("this is a folder, but must be a spec file; name the file in it.")
        if not path.exists():
            raise InputError(_no_such_file(path.name))
        if not path.is_file() or path.stat().st_size > LARGEST_FILE:
            raise InputError("this is not an ordinary file of at most 4 MB; give the path of a spec.")
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(
            "this is not text in UTF-8, but must be a YAML file; give the path of a spec."
        ) from None
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"the file cannot be read ({reason}); check its name and permissions.") from None


def _no_such_file(name: str) -> str:
    shipped = shipped_names()
    near = nearest(name, shipped)
    way_out = f"{near} is one" if near else f"they are {', '.join(shipped)}"
    return f"there is no such file; give the path of a spec, or a shipped one's name: {way_out}."


def _from_folder(name: str, value: Any, spec: Path) -> Any:
    if name == KEY and isinstance(value, list | tuple):
        return [placed(one, spec.parent) if isinstance(one, str) else one for one in value]
    if name in ("load.plant.path", "load.numerical.path") and isinstance(value, str) and value.isprintable():
        return str(spec.parent.absolute() / Path(value).expanduser()) if not value.startswith("~") else value
    return value


def shipped_names() -> tuple[str, ...]:
    """Names of the specs that come with the package."""
    folder = resources.files(__package__) / "shipped"
    return tuple(
        sorted(file.name.removesuffix(".yaml") for file in folder.iterdir() if file.name.endswith(".yaml"))
    )


def shipped_text(name: str) -> str:
    """Text of a shipped spec, comments included."""
    if name not in shipped_names():
        raise InputError(
            f"there is no shipped spec {shown(name)}, only {', '.join(shipped_names())}; "
            f"{suggestion(name, shipped_names()) or 'use one of them'}."
        )
    return (resources.files(__package__) / "shipped" / f"{name}.yaml").read_text(encoding="utf-8")


@cache
def shipped_spec(name: str = "paper") -> Spec:
    """Return a spec that comes with the package; InputError names all of them."""
    return spec_from_parameters(parameters_in(shipped_text(name)))


def spec_at(place: Spec | Path | str, effects: Iterable[str | Path] = ()) -> Spec:
    """Return the spec that a place names: a spec itself, a file, else a shipped spec.

    Parameters
    ----------
    place
        What names it.
    effects
        Python files, or modules, that declare further kinds of effects. They are executed, and become part of
        ``effects_from``.

    Raises
    ------
    InputError
        If it is none of these.
    """
    loaded = load_effects(effects)
    if isinstance(place, Spec):
        return with_effects_from(place, loaded)
    if str(place) in shipped_names() and not Path(place).is_file():
        return with_effects_from(shipped_spec(str(place)), loaded)
    return with_effects_from(read_spec(Path(place)), loaded)
