"""Compiled functions that others call by their addresses.

A caller is then compiled once, whichever functions it calls, and what it is given are numbers.
"""

from collections.abc import Callable
from typing import Any, cast

from numba import types
from numba.extending import intrinsic


def address(function: Any, signature: Any) -> int:
    """Return the address of ``function``, a dispatcher of numba, compiled for ``signature``.

    It holds as long as the function exists in this process. An exception cannot leave a function
    called by its address.
    """
    result = function.get_compile_result(signature)
    found: int = result.library.get_pointer_to_function(result.fndesc.llvm_cfunc_wrapper_name)
    return found


def called(signature: Any) -> Callable[[int], Callable[..., Any]]:
    """Return what turns an address, in compiled code, into a function of ``signature``."""
    pointer = types.ExternalFunctionPointer(signature, int)

    def function_at(_: Any, number: Any) -> tuple[Any, Callable[..., Any]]:
        def pointed(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], context.get_value_type(pointer))

        return pointer(number), pointed

    return cast("Callable[[int], Callable[..., Any]]", intrinsic(function_at))
