"""Normal equations of forces by block of data, and what they leave of data left out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import CURVE_LEAST_RESPONSE, CURVE_RIDGE
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Normal:
    """Normal equations by block, and what is known of the sizes beside the data."""

    hessian: Floats
    gradient: Floats
    squares: Floats
    count: Floats
    prior: Floats

    @property
    def total(self) -> tuple[Floats, Floats]:
        """Hessian and gradient of all blocks."""
        return self.hessian.sum(0) + self.prior, self.gradient.sum(0)

    @property
    def sizes(self) -> Floats:
        """Sizes (p,) that fit best."""
        return solved(*self.total)[0]

    def leading(self, count: int) -> Normal:
        """Those of the first sizes alone."""
        return self.within(np.eye(self.prior.shape[0])[:, :count])

    def within(self, directions: Floats) -> Normal:
        """Those of sizes that are sums of some directions (p, q)."""
        return Normal(
            directions.T @ self.hessian @ directions,
            self.gradient @ directions,
            self.squares,
            self.count,
            directions.T @ self.prior @ directions,
        )

    def stiffened(self, roughness: Floats, stiffness: float) -> Normal:
        """The same with the last sizes held together: `roughness` (p, p), of the mean weight of the data."""
        count = roughness.shape[0]
        weight = float(np.diag(self.total[0])[-count:].mean())
        prior = self.prior.copy()
        prior[-count:, -count:] += stiffness * weight * roughness
        return replace(self, prior=prior)

    def left_out(self) -> Floats:
        """Squared error (b,) of each block under the fit to all others."""
        hessian, gradient = self.total
        sizes, _ = solved(hessian - self.hessian, gradient - self.gradient)
        bent = (self.hessian @ sizes[..., None])[..., 0] - 2.0 * self.gradient
        return np.asarray(self.squares + np.sum(sizes * bent, axis=1))


def normal_of(columns: Floats, left: Floats, blocks: list[slice], precision: Floats) -> Normal:
    """Normal equations of columns (p, s k) for what is left (s k,) in some blocks; the first sizes are known
    with some precision (q,).
    """
    prior = np.zeros(columns.shape[0])
    prior[: precision.size] = precision
    return Normal(
        np.stack([columns[:, b] @ columns[:, b].T for b in blocks]),
        np.stack([columns[:, b] @ left[b] for b in blocks]),
        np.array([squares(left[b]) for b in blocks]),
        np.array([float(np.count_nonzero(left[b])) for b in blocks]),
        np.diag(prior),
    )


def solved(hessian: Floats, gradient: Floats) -> tuple[Floats, Floats]:
    """Sizes (..., p) and covariance (..., p, p) for noise of power 1, of equations (..., p, p), (..., p).

    What the data do not reach has size 0.
    """
    diagonal = np.diagonal(hessian, axis1=-2, axis2=-1)
    reached = diagonal > CURVE_LEAST_RESPONSE * diagonal.max(axis=-1, keepdims=True, initial=0.0)
    scale = np.where(reached, 1.0 / np.sqrt(np.where(reached, diagonal, 1.0)), 0.0)
    both = scale[..., :, None] * scale[..., None, :]
    inverse = np.linalg.inv(hessian * both + CURVE_RIDGE * np.eye(scale.shape[-1])) * both
    return (inverse @ gradient[..., None])[..., 0], inverse


def squares(values: Floats) -> float:
    """Sum of the squares of some values."""
    return float(values @ values)
