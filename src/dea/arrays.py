"""The types of arrays of numbers."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.int64]
Segment = tuple[Array, Array]  # input and output of a stretch of a record
