"""Normal equations by block of data: what a fit needs, what it leaves open, and what it is worth unseen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rthm_analysis.diagnosis.criteria.fitting import SINGULAR_EIGENVALUE, UNDETERMINED_SHARE
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Sums:
    """Normal equations of a model, by block of the training data.

    Attributes
    ----------
    hessian : (b, p, p), gradient : (b, p), squares : (b,) arrays
        J'J, J'r and r'r of each block.
    precision : (p,) array
        Of the priors.
    pull : (p,) array
        Gradient of the priors.
    """

    hessian: Floats
    gradient: Floats
    squares: Floats
    precision: Floats
    pull: Floats

    def covariance(self) -> Floats:
        """Covariance of the parameters, honest when the residual is not white: from the scatter of blocks.

        What the data leave open has an infinite variance.
        """
        whole = self.hessian.sum(0) + np.diag(self.precision)
        inverse, open_ = _inverse(whole)
        scatter = self.gradient.T @ self.gradient
        seen = inverse @ (scatter + np.diag(self.precision)) @ inverse
        covariance = _larger(inverse, seen)
        covariance[open_, open_] = np.inf
        return covariance

    def left_out(self) -> Floats:
        """Squared error (b,) of each block under the fit to all others, by one Newton step.

        Raises
        ------
        numpy.linalg.LinAlgError
            When the sums are not finite.
        """
        if not np.isfinite(self.hessian).all() or not np.isfinite(self.gradient).all():
            raise np.linalg.LinAlgError("sums of squares are not finite")
        whole = self.hessian.sum(0) + np.diag(self.precision)
        errors = np.empty(self.squares.size)
        for b in range(self.squares.size):
            step = np.linalg.lstsq(whole - self.hessian[b], -self.gradient[b], rcond=1e-12)[0]
            change = -2.0 * step @ self.gradient[b] + step @ self.hessian[b] @ step
            errors[b] = self.squares[b] + max(change, 0.0)
        return errors


def _inverse(matrix: Floats) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """Inverse on what the data determine, and the parameters (p,) that take part in what they do not."""
    size = np.sqrt(np.diag(matrix))
    scale = np.where(size > 0.0, size, 1.0)
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    known = values > SINGULAR_EIGENVALUE
    inverse = (vectors[:, known] / values[known]) @ vectors[:, known].T / np.outer(scale, scale)
    part = np.square(vectors[:, ~known]).sum(axis=1)
    return inverse, part > UNDETERMINED_SHARE


def _larger(inverse: Floats, seen: Floats) -> Floats:
    """Covariance with the larger of two variances for each parameter."""
    ratio = np.sqrt(np.maximum(np.diag(seen) / np.maximum(np.diag(inverse), 1e-300), 1.0))
    return np.asarray(inverse * np.outer(ratio, ratio))
