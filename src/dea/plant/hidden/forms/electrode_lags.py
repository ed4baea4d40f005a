"""Lags of electrodes: with a stray capacity, of one that warms, of many times, of its kinetics."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, reporting, tuning
from dea.plant.hidden.forms.kernels import parallel
from dea.plant.signal_law import SignalLaw


@tuning("Millman and Taub, Pulse, Digital, and Switching Waveforms (1965): a divider with strays")
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


@tuning("Doljack, IEEE Trans. Compon. Hybrids Manuf. Technol. 4 (1981) 372: a composite that warms")
def warming_composite(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lag of ``size`` band periods that becomes up to 1.5 to 3 times as long where current warms.

    Warmth comes and goes within 2 to 8 band periods.
    """
    growth, warming = rng.uniform(0.5, 2.0), rng.uniform(2.0, 8.0) * conditions.time
    scale = size / (1.0 + 2.0 * size) * conditions.span
    constants = [size * conditions.time, growth, scale, warming]
    return Built(SignalLaw(_warmed, constants, np.zeros(3)), {})


@reporting("Wagner, Ann. Phys. 40 (1913) 817: relaxation times whose logarithms are normal")
def lognormal_times(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Forty equal lags side by side, of a deviation of 0.7 to 1.4 of the logarithms.

    Their mean delay is ``size`` band periods.
    """
    from scipy.special import ndtri

    mean = size * conditions.time
    times = np.exp(rng.uniform(0.7, 1.4) * ndtri((np.arange(40) + 0.5) / 40.0))
    law = parallel(0.0, np.full(40, 1.0 / 40.0), mean * times / times.mean())
    return Built(law, {"lag": mean})


@njit(cache=True)
def _transferred(c: Array, m: Array, u: Array) -> None:
    """Follow at a rate exp(a x) - exp(-(1 - a) x) of the error x, by the implicit rule.

    c: unit of x, a, and a sub-step over the time of the lag; m: started and value.
    """
    unit, share, step = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = (u[k] - m[1]) / unit
        ahead = share if error > 0.0 else 1.0 - share
        size = abs(error)
        # From above the root, by Newton's rule.
        x = min(size, np.log1p(size / step) / ahead)
        for _ in range(20):
            rising, falling = np.exp(ahead * x), np.exp((ahead - 1.0) * x)
            excess = x - size + step * (rising - falling)
            x -= excess / (1.0 + step * (ahead * rising + (1.0 - ahead) * falling))
            if abs(excess) < 1e-12 * size:
                break
        m[1] = u[k] - (unit * x if error > 0.0 else -unit * x)
        u[k] = m[1]


@reporting(
    "Erdey-Grúz and Volmer, Z. Phys. Chem. A 150 (1930) 203: charge transfer at an electrode"
)
def charge_transfer(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lag of ``size`` band periods, ever less for errors above 0.05 to 0.3 of the range.

    It lessens more one way than the other, with exponents of 0.25 to 0.4 and the rest of 1.
    """
    unit, share = rng.uniform(0.05, 0.3) * conditions.span, rng.uniform(0.25, 0.4)
    share = share if rng.random() < 0.5 else 1.0 - share
    constants = [unit, share, SUBSTEP / (size * conditions.time)]
    return Built(SignalLaw(_transferred, constants, [0.0, 0.0]), {})
