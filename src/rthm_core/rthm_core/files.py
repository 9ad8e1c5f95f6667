"""Files that a user asked for: whole or not there, and one sentence where they cannot be written."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from rthm_core.errors import InputError

WAYS_OUT = {
    errno.ENOSPC: "make room, or name a place that has some",
    errno.EDQUOT: "make room, or name a place that has some",
    errno.ENOENT: "name a folder that is there, or make it first",
    errno.EISDIR: "name a file",
}
"""What to do, by the kind of failure."""

ELSE = "name a place that you may write to"


def not_written(path: str | Path, error: OSError) -> InputError:
    """One sentence about a file that could not be written.

    Examples
    --------
    >>> str(not_written("a.json", OSError(errno.ENOSPC, "No space left on device")))
    'a.json cannot be written (no space left on device); make room, or name a place that has some.'
    """
    reason = (error.strerror or str(error)).lower()
    way_out = WAYS_OUT.get(error.errno or 0, ELSE)
    return InputError(f"{path} cannot be written ({reason}); {way_out}.")


def check_place(option: str, path: str | Path) -> None:
    """Refuse the path of a file that cannot be written, before the work that fills it.

    Raises
    ------
    InputError
        If it is empty or a folder, or its folder is not there.
    """
    place = Path(path)
    if not str(path) or place.is_dir():
        raise InputError(f"{option} is {str(path)!r}, a folder, but must be a file; name one in it.")
    if not place.parent.is_dir():
        raise InputError(
            f"{place.parent} is not a folder, so {place.name} cannot be written there; make it first."
        )


def check_new(option: str, path: str | Path) -> None:
    """Refuse the path of a file that is there already, or that cannot be written.

    Raises
    ------
    InputError
        Also if it is empty or a folder, or its folder is not there.
    """
    check_place(option, path)
    if Path(path).exists() or Path(path).is_symlink():
        raise InputError(
            f"{path} is there already, but {option} must be a new file, as nothing is overwritten; name "
            "another one, or remove it first."
        )


def write_whole(path: str | Path, text: str) -> None:
    """Write a text file that appears at once, so that nobody ever finds half of it.

    Raises
    ------
    InputError
        If it cannot be written; then what was there before is still there.
    """
    place = Path(path)
    draft = place.with_name(f".{place.name}.{os.getpid()}")
    try:
        if place.exists() and not place.is_file():  # a pipe or a device
            place.write_text(text, encoding="utf-8")
            return
        draft.write_text(text, encoding="utf-8")
        draft.replace(place)
    except OSError as error:
        draft.unlink(missing_ok=True)
        raise not_written(path, error) from error
