"""Compiled functions that never run by themselves: their callers take them in, and optimise them there.

Numba optimises every function, and makes machine code of it, before it hands it to a caller, which then
optimises all of it once more. Of a chain of functions, each part of the next, all that is below is so
optimised at each link; here it is once, at the top. What is at the top may be optimised otherwise, too.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary

from rthm_core.compile_quickly import Quick

LEVEL = 2
"""Of LLVM's optimisation; its third takes longer and makes such code no quicker."""


WAY_IN = "_ZN7cpython"
"""Begins the name of what takes the arguments of a function from Python."""


def _leave(module: Any) -> None:
    """Have ways in from Python optimised no further: they run once where the rest loops, and are long."""
    for function in module.functions:
        if function.name.startswith(WAY_IN) and not function.is_declaration:
            for attribute in ("noinline", "optnone"):
                function.add_function_attribute(attribute)


class _TidiedOnly(JITCodeLibrary):  # type: ignore[misc]
    """Code whose functions are made small before they are linked, and optimised afterwards."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout
        _leave(ll_module)
        options = llvm.create_pipeline_tuning_options(speed_level=1)
        options.loop_unrolling = False
        builder = llvm.create_pass_builder(self._codegen._tm, options)
        passes = builder.getFunctionPassManager()
        for function in ll_module.functions:
            if not function.is_declaration:
                passes.run(function, builder)


class _Part(_TidiedOnly):
    """Code that is only linked into that of callers."""

    def _optimize_final_module(self) -> None:
        """Left to the callers."""

    def _finalize_final_module(self) -> None:
        """Give the engine the variables that numba fills for this code, and nothing else to compile."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._codegen._add_module(self._variables())
        self._codegen._engine.finalize_object()
        self._finalized = True

    def _variables(self) -> Any:
        module = llvm.parse_assembly(
            "\n".join(
                str(one) for one in self._final_module.global_variables if one.linkage is llvm.Linkage.common
            )
        )
        module.triple, module.data_layout = self._final_module.triple, self._codegen._data_layout
        return module

    def _get_compiled_object(self) -> bytes:
        """Machine code that is kept on disk beside what is linked."""
        return bytes(self._codegen._tm.emit_object(self._variables()))


class _WrittenOutPart(_Part):
    """The same, with loops written out before it is linked, where the numbers of their turns are known."""

    def _optimize_functions(self, ll_module: Any) -> None:
        JITCodeLibrary._optimize_functions(self, ll_module)


class PartOfCallers(Quick):
    """How numba compiles such a function."""

    library = _Part

    def compile_extra(self, function: Any) -> Any:
        """Compile a function in Python."""
        self.state.library = self.library(self.state.targetctx.codegen(), function.__qualname__)
        return super().compile_extra(function)


class WrittenOutPart(PartOfCallers):
    """How numba compiles one with loops over tuples: the outer ones are written out first, and the inner ones
    then have as many turns as is known when they are compiled.
    """

    library = _WrittenOutPart


class _Plain(_TidiedOnly):
    """Code that is optimised once, and whose loops are left as they are."""

    unrolls = False

    def _optimize_final_module(self) -> None:
        options = llvm.create_pipeline_tuning_options(speed_level=LEVEL)
        options.loop_vectorization = options.slp_vectorization = False
        options.loop_unrolling = self.unrolls
        builder = llvm.create_pass_builder(self._codegen._tm, options)
        manager = builder.getModulePassManager()
        with self._recorded_timings.record("Module passes", builder):
            manager.run(self._final_module, builder)


class _Unrolled(_Plain):
    """The same, but loops over a tuple are written out, which then stays in registers."""

    unrolls = True


class Plain(Quick):
    """How numba compiles what goes through loops of a few turns.

    Left to itself it optimises everything twice, for the sake of counted references in between, makes vectors
    of each loop and writes several turns out: with three or four turns that takes longer than the loop, and
    it is most of the code.
    """

    library = _Plain

    def compile_extra(self, function: Any) -> Any:
        """Compile a function in Python."""
        self.state.library = self.library(self.state.targetctx.codegen(), function.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(function)


class PlainUnrolled(Plain):
    """How numba compiles what goes through loops over tuples."""

    library = _Unrolled
