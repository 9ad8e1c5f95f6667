"""Keep what was computed from a spec, for the next call with the same spec."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from rthm_core.spec import Spec

Value = TypeVar("Value")

RESULTS_KEPT = 64
"""How many results each function keeps."""


def kept(function: Callable[..., Value]) -> Callable[..., Value]:
    """Keep results by the identity of the spec, which is immutable, and by the other arguments.

    Comparing two specs entry by entry costs more than many a simulation.
    """
    results: OrderedDict[Any, tuple[Spec, Value]] = OrderedDict()

    def looked_up(spec: Spec, *arguments: Any) -> Value:
        key = (id(spec), *arguments)
        found = results.get(key)
        if found is None:
            found = results[key] = (spec, function(spec, *arguments))
            if len(results) > RESULTS_KEPT:
                results.popitem(last=False)
        return found[1]

    return looked_up
