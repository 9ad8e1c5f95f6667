"""Keep what was computed from a spec, for the next call with the same spec, or with one that has the same
sections where they matter.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from rthm_core.spec import Spec

Value = TypeVar("Value")
Function = Callable[..., Value]

RESULTS_KEPT = 64
"""How many results each function keeps."""


def kept(function: Function[Value]) -> Function[Value]:
    """Keep results by the identity of the spec, which is immutable, and by the other arguments.

    Comparing two specs entry by entry costs more than many a simulation.
    """
    return _kept(function, lambda spec: (id(spec),))


def kept_without_timing(function: Function[Value]) -> Function[Value]:
    """Keep results by the identity of all sections but ``timing``, on which they do not depend: those of one
    loop serve all that differ from it in periods and delays (`apply` leaves the other sections as they are).
    """
    return _kept(function, _without_timing)


def kept_by_clocks(function: Function[Value]) -> Function[Value]:
    """Keep results by the identity of what gives periods, delays and their chance, on which alone they
    depend.
    """
    return _kept(function, _clocks)


def _without_timing(spec: Spec) -> tuple[int, ...]:
    others = [id(value) for name, value in vars(spec).items() if name not in ("timing", "effects")]
    return (*others, *map(id, spec.effects))


def _clocks(spec: Spec) -> tuple[int, ...]:
    return id(spec.timing), id(spec.noise), *map(id, spec.effects)


def _kept(function: Function[Value], identity: Callable[[Spec], tuple[int, ...]]) -> Function[Value]:
    results: OrderedDict[Any, tuple[Spec, Value]] = OrderedDict()

    def looked_up(spec: Spec, *arguments: Any, **named: Any) -> Value:
        key = (identity(spec), *arguments, *named.values())
        found = results.get(key)
        if found is None:
            found = results[key] = (spec, function(spec, *arguments, **named))
            if len(results) > RESULTS_KEPT:
                results.popitem(last=False)
        return found[1]

    return looked_up
