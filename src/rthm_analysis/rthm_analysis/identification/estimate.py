"""Estimates with standard deviations that hold where the errors of neighbouring samples belong together."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

BLOCKS = 40
"""Stretches of a recording whose errors are taken as independent of each other."""
BEYOND_ZERO = 4.0
"""Standard deviations beyond which a number is not zero."""


class Fit(NamedTuple):
    """Numbers that were fitted.

    Attributes
    ----------
    value : (p,) array
    covariance : (p, p) array
    left : (s,) array
        What the fit leaves of each sample.
    """

    value: Floats
    covariance: Floats
    left: Floats

    @property
    def std(self) -> Floats:
        """Standard deviations (p,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def is_certain(self, i: int) -> bool:
        """Whether a number is certainly not zero."""
        return bool(abs(self.value[i]) > BEYOND_ZERO * self.std[i])


def covariance(instruments: Floats, regressors: Floats, left: Floats) -> Floats:
    """Covariance (p, p) of a linear fit, from what it leaves of stretches of samples.

    Where few stretches tell most, they may agree by chance: it is never less than for samples that are
    independent of each other.

    Parameters
    ----------
    instruments, regressors : (s, p) arrays
        The same for least squares.
    left : (s,) array
    """
    edges = np.linspace(0, left.size, BLOCKS + 1).astype(int)[:-1]
    scores = np.add.reduceat(instruments * left[:, None], edges, axis=0)
    inverse = np.linalg.pinv(instruments.T @ regressors)
    spread = BLOCKS / (BLOCKS - 1) * scores.T @ scores
    alone = np.mean(np.square(left)) * instruments.T @ instruments
    together, apart = (inverse @ one @ inverse.T for one in (spread, alone))
    with np.errstate(invalid="ignore", divide="ignore"):
        more = np.sqrt(np.maximum(np.diag(apart) / np.diag(together), 1.0))
    more[~np.isfinite(more)] = 1.0
    return np.asarray(together * np.outer(more, more))


def through(regressors: Floats, values: Floats) -> Fit:
    """Fit ``values = regressors @ p + constant`` where regressors (s, p) are as noisy as the values.

    A noisy regressor makes plain least squares too small. Here each sample of it is weighed by its
    neighbours, whose noise is not its own. The constant comes last.
    """
    near = np.vstack([regressors[:1], regressors, regressors[-1:]])
    constant = np.ones((values.size, 1))
    inner = slice(1, -1)
    x = np.hstack([regressors, constant])[inner]
    z = np.hstack([0.5 * (near[:-2] + near[2:]), constant])[inner]
    y = values[inner]
    p = np.linalg.pinv(z.T @ x) @ (z.T @ y)
    left = y - x @ p
    return Fit(p, covariance(z, x, left), left)
