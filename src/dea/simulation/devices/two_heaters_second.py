"""The second temperature of ``two_heaters``: the same physics, read by the other sensor."""

from dataclasses import replace

import numpy as np
from numba import njit

from dea.simulation.devices import two_heaters as first
from dea.simulation.signatures import DERIVATIVE_OF_SEVERAL


@njit(DERIVATIVE_OF_SEVERAL, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: np.ndarray, p: np.ndarray, dx: np.ndarray) -> None:
    """Heat balances of both transistors, and the lag of the second one's sensor."""
    first.derivative(x, u, p, dx)
    dx[2] = (x[1] - x[2]) / p[4]


simulation = replace(first.simulation, name="two_heaters_second", derivative=derivative)
