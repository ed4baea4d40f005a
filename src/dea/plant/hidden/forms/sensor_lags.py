"""Lags of a thermometer in still air, and of a voltmeter that shows one mean after the other."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, reporting
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _convected(c: Array, m: Array, y: Array) -> None:
    """Follow at a rate that is a power 1 + c[1] of the error, exactly at a held output.

    c[0]: the rate in a sub-step at an error of c[2]; m: started and value.
    """
    share, power, scale = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0]
    for k in range(y.shape[0]):
        error = y[k] - m[1]
        lessened = 1.0 + power * share * (abs(error) / scale) ** power
        m[1] = y[k] - error * lessened ** (-1.0 / power)
        y[k] = m[1]


@reporting("McAdams, Heat Transmission (1954): natural convection, a power 5/4 or 4/3")
def still_air(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A thermometer in still air, laminar or turbulent, slower as it comes near.

    At an error of 0.05 to 0.3 travels it is a lag of ``size`` band periods.
    """
    scale = rng.uniform(0.05, 0.3) * conditions.travel
    constants = [SUBSTEP / (size * conditions.time), rng.choice([1.0 / 4.0, 1.0 / 3.0]), scale]
    return Built(SignalLaw(_convected, constants, [0.0, 0.0], output=True), {})


@njit(cache=True)
def _shown(c: Array, m: Array, y: Array) -> None:
    """Show the mean over each c[0] values when the last has come, and before the first value.

    m: count, sum, what is shown, and whether started.
    """
    if m[3] == 0.0:
        m[2], m[3] = y[0], 1.0
    for k in range(y.shape[0]):
        m[0] += 1.0
        m[1] += y[k]
        if m[0] == c[0]:
            m[2], m[0], m[1] = m[1] / c[0], 0.0, 0.0
        y[k] = m[2]


@reporting(
    "Oliver and Cage, Electronic Measurements and Instrumentation (1971): a digital voltmeter"
)
def digital_voltmeter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Means over windows of ``size`` band periods, each shown until the next is there."""
    window = max(round(size * conditions.time / SUBSTEP) + 1, 2)
    law = SignalLaw(_shown, [window], np.zeros(4), output=True)
    return Built(law, {"lag": (window - 1) * SUBSTEP})
