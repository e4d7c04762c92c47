"""What Numba is told to leave out when it compiles: seven tenths of the time are left.

By itself it optimises each function alone, makes machine code of it, and does both again wherever the function is part
of another. What kernels are made of is only ever part of them: it is tidied alone, so that it can be inlined, and then
optimised in the kernel that it is part of, once, and nowhere else.
"""

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, DefaultPassBuilder


class _Library(JITCodeLibrary):
    """Code that Python calls: it is optimised when all that it is made of is in it, and not before."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout


class _Part(JITCodeLibrary):
    """Code that becomes part of other code: no machine code is made of it."""

    @property
    def codegen(self) -> Any:
        """What Numba asks to let machine code know its environment, by which it would raise exceptions."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Leave out the environment."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of a function that is not there."""
        self._ensure_finalized()
        return 0


IDLE = ("inline_closure_likes", "inline_inlinables", "inline_overloads", "nopython_rewrites")


class Whole(Compiler):
    """Compiles what Python calls."""

    library: type[JITCodeLibrary] = _Library

    def define_pipelines(self) -> Any:
        """Return Numba's usual passes, but for those that look for what no kernel has: closures, array expressions."""
        self.state.library = self.library(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        self.state.library.enable_object_caching()
        manager: Any = DefaultPassBuilder.define_nopython_pipeline(self.state)
        manager.passes = [(found, told) for found, told in manager.passes if found._name not in IDLE]
        manager.finalize()
        return [manager]


class Part(Whole):
    """Compiles what kernels are made of."""

    library = _Part


class Body(Part):
    """Compiles a kernel's body: what it writes is none of the other arrays that it is handed."""

    def define_pipelines(self) -> Any:
        """Return Numba's usual passes."""
        self.state.flags.noalias = True
        return super().define_pipelines()
