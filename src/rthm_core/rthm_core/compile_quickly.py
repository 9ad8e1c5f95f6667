"""Numba without what it does for code of other kinds, and without doing things twice: most of the time that
compiling takes is Python.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest.mock import patch

from numba.core import typed_passes, untyped_passes
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager
from numba.core.cpu import CPUContext
from numba.core.types.functions import BaseFunction
from numba.core.typing.context import Context

_PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,
    untyped_passes.GenericRewrites,
    untyped_passes.ReconstructSSA,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.IRLegalization,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)
"""What numba does with a function of numbers, arrays and records that has no closures, no arithmetic of whole
arrays and no ``with``.
"""


class Quick(Compiler):  # type: ignore[misc]
    """How numba compiles such a function."""

    def define_pipelines(self) -> list[Any]:
        """Passes, as numba asks for them."""
        manager = PassManager("nopython")
        for one in _PASSES:
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]

    def compile_extra(self, function: Any) -> Any:
        """Compile a function in Python."""
        with _nothing_twice():
            return super().compile_extra(function)


@contextmanager
def _nothing_twice() -> Iterator[None]:
    """Let numba neither look for garbage, as nearly all that it makes is in use until it ends, nor import its
    own modules for every function, nor find out anew what an operator does with types that it has met.

    What is compiled on the way, because something calls it, finds all this done.
    """
    if Context.load_additional_registries is _look_at_known:
        yield
        return
    is_enabled = gc.isenabled()
    gc.disable()
    with ExitStack() as replaced:
        for context in (Context, CPUContext):
            replaced.enter_context(patch.object(context, "load_additional_registries", _look_at_known))
        typing, size = _remembered(BaseFunction.get_call_type), _remembered(CPUContext.get_abi_sizeof, 1)
        replaced.enter_context(patch.object(BaseFunction, "get_call_type", typing))
        replaced.enter_context(patch.object(CPUContext, "get_abi_sizeof", size))
        try:
            yield
        finally:
            if is_enabled:
                gc.enable()


def _look_at_known(context: Any) -> None:
    """See what has been registered since, where something was before."""
    for registry in list(context._registries):
        context.install_registry(registry)


def _remembered(method: Callable[..., Any], first: int = 0) -> Callable[..., Any]:
    """A method that finds out once what it answers to the same arguments, from the `first` on."""
    answers: dict[Any, Any] = {}

    def answer(*arguments: Any) -> Any:
        key = tuple(tuple(one.items()) if isinstance(one, dict) else one for one in arguments[first:])
        if key not in answers:
            answers[key] = method(*arguments)
        return answers[key]

    return answer
