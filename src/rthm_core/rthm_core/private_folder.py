"""A folder that only its user can write: what is read from it was put there by nobody else.

Compiled code is kept as pickles, and to read a pickle is to execute it.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from pathlib import Path

ROOT = 0


class NotPrivateError(Exception):
    """Others can write a folder, or could; the message says who and where, as a clause."""


def make_private(folder: Path) -> None:
    """Make a folder, or see that one that is there is private to this user, with all that is in it.

    What this user owns and others might only write from now on is closed to them.

    Raises
    ------
    NotPrivateError
        When somebody else owns it or anything in it, or could put another one in its place.
    OSError
        When it cannot be made or looked at.
    """
    folder = folder.absolute()
    for parent in reversed(folder.parents):
        if not parent.exists():
            parent.mkdir(mode=0o700, exist_ok=True)
        _refuse_replaceable(parent)
    folder.mkdir(mode=0o700, exist_ok=True)
    for path, found in _all(folder):
        if found.st_uid != os.geteuid():
            raise NotPrivateError(f"{path} belongs to user {found.st_uid}")
    if folder.stat().st_mode & 0o077:
        folder.chmod(0o700)


def _all(folder: Path) -> Iterator[tuple[Path, os.stat_result]]:
    """The folder itself and all that is in it; links are not followed."""
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        raise NotPrivateError(f"{folder} is a link or a file")
    yield folder, found
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            path = Path(place, name)
            yield path, path.lstat()


def _refuse_replaceable(parent: Path) -> None:
    """Refuse a folder whose entries somebody else than root and this user can rename or remove."""
    found = parent.stat()
    if found.st_uid not in (ROOT, os.geteuid()):
        raise NotPrivateError(f"{parent} belongs to user {found.st_uid}")
    theirs = found.st_mode & stat.S_IWOTH or (found.st_mode & stat.S_IWGRP and found.st_gid != os.getegid())
    if theirs and not found.st_mode & stat.S_ISVTX:
        raise NotPrivateError(f"others can write {parent}")
