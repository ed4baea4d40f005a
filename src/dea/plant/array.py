"""The type of values from which the modules of this package make arrays."""

from collections.abc import Sequence

from dea.arrays import Array

Values = Sequence[float] | Array
