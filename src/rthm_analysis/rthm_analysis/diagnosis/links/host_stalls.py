"""What the uses of a link still say where hosts stalled at times."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.timing.host_stalls import FAR, next_stall
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers


def without_stalls(
    spans: Integers, sent: Integers, due: Integers, looks: Integers | None, low: Floats, high: Floats
) -> tuple[Floats, Floats]:
    """Bounds of extra delays (n,) without what a stalled host has done to them.

    A sample tells nothing when a host stalled before its receiver first looked for it. When that
    happened later, the receiver looked in vain only up to then.

    Parameters
    ----------
    spans : (k, 2) array
        As from `host_stalls`.
    sent, due : (n,) arrays
        Stamps of the samples by the sender's clock, and when the spec says that they arrive, ns.
    looks : (u,) array or None
        When the receiver looked, ns; None: it uses samples as they come.
    low, high : (n,) arrays
        ``low < extra delay <= high``, s.
    """
    stands = next_stall(spans, sent)
    if looks is None:
        first, in_vain = due, stands
    else:
        first = np.append(looks, FAR)[np.searchsorted(looks, due)]
        in_vain = looks[np.maximum(np.searchsorted(looks, stands) - 1, 0)]
    tells = stands > first
    low = np.where(tells, np.minimum(low, (in_vain - due) / NS), -np.inf)
    return low, np.where(tells, high, np.inf)
