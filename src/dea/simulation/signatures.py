"""Signatures of the compiled functions that simulations and effects are made of.

They enter the integrator as first-class functions of fixed signatures, so that neither a new
effect nor a new parameter compiles anything.
"""

import warnings
from collections.abc import Callable
from functools import cache
from typing import Any, cast

import numpy as np
from numba import float64, int64, njit, types
from numba.core.errors import NumbaExperimentalFeatureWarning
from numba.extending import intrinsic, typeof_impl

from dea.by_address import address

# Numba calls first-class functions experimental; without them each pair of a simulation and its
# effects would be compiled.
warnings.filterwarnings("ignore", category=NumbaExperimentalFeatureWarning)

VECTOR = types.Array(float64, 1, "C")
MATRIX = types.Array(float64, 2, "C")
CUBE = types.Array(float64, 3, "C")
INDEX = types.Array(int64, 2, "C")
INDICES = types.Array(int64, 1, "C")
DERIVATIVE = types.void(VECTOR, float64, VECTOR, VECTOR)
OUTPUT = float64(VECTOR, float64, VECTOR)
# The same of several inputs, whose values at one instant are a row.
DERIVATIVE_OF_SEVERAL = types.void(VECTOR, VECTOR, VECTOR, VECTOR)
OUTPUT_OF_SEVERAL = float64(VECTOR, VECTOR, VECTOR)
FORCE = float64(float64, float64, VECTOR, VECTOR)
UPDATE = types.void(float64, float64, float64, VECTOR, VECTOR)

SLOTS = 3
MEMORY = 32


def compiled(function: Callable[..., Any], signature: Any) -> Any:
    """Compile ``function`` for ``signature``, unless it is compiled just so."""
    options = getattr(function, "targetoptions", {})
    made_for = [str(own) for own in getattr(function, "nopython_signatures", ())]
    if options.get("error_model") == "numpy" and made_for == [str(signature)]:
        return function
    # A division by zero gives an infinity, which a fit can reject; an exception would end the fit.
    return njit(signature, error_model="numpy")(getattr(function, "py_func", function))


class FirstClass(types.WrapperAddressProtocol):
    """A compiled function as an argument of another one, its address and type looked up once.

    Numba looks up those of a plain one at every call, which takes longer than a short record
    does. An exception would not leave such a function.
    """

    def __init__(self, function: Any) -> None:
        self._function = function
        (self._signature,) = function.nopython_signatures
        self._address = address(function, self._signature)
        self.numba_type = types.FunctionType(self._signature)

    def __wrapper_address__(self) -> int:
        return self._address

    def signature(self) -> Any:
        """Return the signature the function is compiled for."""
        return self._signature


@typeof_impl.register(FirstClass)
def _type_of(function: FirstClass, context: Any) -> types.FunctionType:
    return function.numba_type


first_class = cache(FirstClass)


def _borrowed(_: Any, array: types.Array) -> tuple[Any, Callable[..., Any]]:
    def without_count(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(array)(context, builder, arguments[0])
        view.meminfo = view.meminfo.type(None)
        return view._getvalue()

    return array(array), without_count


borrowed = cast("Callable[[np.ndarray], np.ndarray]", intrinsic(_borrowed))
"""Return, in compiled code, an array whose references are not counted, of one that outlives it.

A compiled function counts the references to an array that it is given, unless it is very plain; the
atomic counts took half of the time of a simulation.
"""


@njit(FORCE, cache=True)
def no_force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Fill an empty slot."""
    return 0.0


@njit(UPDATE, cache=True)
def no_update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Fill the slot of a force without memory."""
