"""Load a spec."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from rthm_core.spec import Spec, spec_at

Named = Spec | Path | str
"""What names a spec: the name of a shipped one, a path, or a spec."""


def load(spec: Named, effects: Iterable[str | Path] = ()) -> Spec:
    """Return the description of a test.

    Parameters
    ----------
    spec : str, Path or Spec
        Name of a shipped spec (``rthm specs`` lists them), path of a spec file, or a spec.
    effects : iterable of str or Path
        Python files, or modules, that declare further kinds of effects. They are executed; so is what
        ``effects_from`` in a spec file names.

    Returns
    -------
    Spec
        Immutable; ``rthm_core.spec.apply`` gives a changed one.

    Raises
    ------
    InputError
        If there is no such spec (the nearest name is told), or something in it is not allowed.

    Examples
    --------
    >>> import rthm
    >>> rthm.load("paper").plant.mass
    (1.2,)
    >>> rthm.load("papr")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    rthm_core.errors.InputError: papr: there is no such file; ... paper is one.
    """
    return spec_at(spec, effects)
