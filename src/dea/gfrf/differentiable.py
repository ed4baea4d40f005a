"""Arrays that carry their derivative by a set of parameters (forward-mode differentiation).

The rules are those of the derivative itself, so it is exact to rounding: A. Griewank and
A. Walther, Evaluating Derivatives, SIAM (2008), chapter 3.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class Differentiable:
    """A value, shape (...), and its derivative by each of k parameters, shape (k, ...).

    It stands for an array in sums, products, quotients, whole powers and indexing. Plain arrays
    that are combined with it have no more axes than the value.
    """

    __array_ufunc__ = None  # numpy leaves ``array * differentiable`` to the methods below

    def __init__(self, value: Array, slope: Array) -> None:
        self.value, self.slope = value, slope

    def __add__(self, other: Any) -> "Differentiable":
        if isinstance(other, Differentiable):
            return Differentiable(self.value + other.value, self.slope + other.slope)
        return Differentiable(self.value + other, self.slope)

    def __mul__(self, other: Any) -> "Differentiable":
        if isinstance(other, Differentiable):
            slope = self.slope * other.value + self.value * other.slope
            return Differentiable(self.value * other.value, slope)
        return Differentiable(self.value * other, self.slope * other)

    def __truediv__(self, other: Any) -> "Differentiable":
        if isinstance(other, Differentiable):
            quotient = self.value / other.value
            return Differentiable(quotient, (self.slope - quotient * other.slope) / other.value)
        return Differentiable(self.value / other, self.slope / other)

    def __rtruediv__(self, other: Any) -> "Differentiable":
        quotient = other / self.value
        return Differentiable(quotient, -quotient * self.slope / self.value)

    def __pow__(self, power: int) -> "Differentiable":
        if power == 0:
            return Differentiable(np.ones_like(self.value), np.zeros_like(self.slope))
        slope = power * self.value ** (power - 1) * self.slope
        return Differentiable(self.value**power, slope)

    def __rsub__(self, other: Any) -> "Differentiable":
        return Differentiable(other - self.value, -self.slope)

    __radd__ = __add__
    __rmul__ = __mul__

    def __getitem__(self, index: Any) -> "Differentiable":
        indices = index if isinstance(index, tuple) else (index,)
        return Differentiable(self.value[indices], self.slope[(slice(None), *indices)])
