"""Packages that only some results need."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from rthm_core.errors import InputError


def needed(package: str, what: str) -> Any:
    """Import a package.

    Raises
    ------
    InputError
        If it is not installed; says that `what` needs it, and how to get it.
    """
    try:
        return import_module(package)
    except ImportError:
        raise InputError(
            f"{what} needs the package {package}, which is not installed; install it with "
            f"`pip install {package}`."
        ) from None
