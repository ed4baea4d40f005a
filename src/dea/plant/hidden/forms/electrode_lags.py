"""Lags of an electrode with a stray capacity, and of one that warms."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, reporting
from dea.plant.hidden.forms.kernels import parallel
from dea.plant.signal_law import SignalLaw


@reporting(
    "Millman and Taub, Pulse, Digital, and Switching Waveforms (1965): a divider with strays"
)
def stray_capacity(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A share of 0.1 to 0.35 comes at once across the resistance, the rest as a single lag.

    Its mean delay is ``size`` band periods.
    """
    mean, share = size * conditions.time, rng.uniform(0.1, 0.35)
    law = parallel(share, np.array([1.0 - share]), np.array([mean / (1.0 - share)]))
    return Built(law, {"lag": mean})


@njit(cache=True)
def _warmed(c: Array, m: Array, u: Array) -> None:
    """A first-order lag of c[0] s, up to 1 + c[1] times as long where it is warm.

    c: besides, the error that makes it half warm when it lasts, and the time of the warming; m:
    started, value, and warmth, a power over its scale.
    """
    time, growth, scale, warming = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error, resistance = u[k] - m[1], 1.0 + growth * m[2] / (1.0 + m[2])
        m[1] -= np.expm1(-SUBSTEP / (time * resistance)) * error
        m[2] += SUBSTEP / warming * ((error / scale) ** 2 / resistance - m[2])
        u[k] = m[1]


@reporting(
    "Doljack, IEEE Trans. Compon. Hybrids Manuf. Technol. 4 (1981) 372: a composite that warms"
)
def warming_composite(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lag of ``size`` band periods that becomes up to 1.5 to 3 times as long where current warms.

    Warmth comes and goes within 2 to 8 band periods.
    """
    growth, warming = rng.uniform(0.5, 2.0), rng.uniform(2.0, 8.0) * conditions.time
    scale = size / (1.0 + 2.0 * size) * conditions.span
    constants = [size * conditions.time, growth, scale, warming]
    return Built(SignalLaw(_warmed, constants, np.zeros(3)), {})
