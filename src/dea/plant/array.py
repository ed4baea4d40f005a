"""What becomes an array, in this room."""

from collections.abc import Sequence

from dea.arrays import Array

Values = Sequence[float] | Array
