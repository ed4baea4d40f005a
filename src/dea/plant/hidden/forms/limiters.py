"""Limiters of command and reading: of bridges, of programmes, in stages, rippled and cubic."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, reporting, tuning
from dea.plant.hidden.forms.kernels import bent_above, command_curve, reading_curve
from dea.plant.signal_law import SignalLaw


@reporting("Holtz, Proc. IEEE 82 (1994) 1194: a bridge that is modulated by more than its supply")
def overmodulated_bridge(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above the knee the fundamental of a sine whose peaks are cut, 4/π of the knee at most."""
    knee = conditions.high - size * conditions.span

    def modulated(u: Array) -> Array:
        x = knee / np.maximum(u, knee)
        value: Array = 2.0 / np.pi * np.maximum(u, knee) * (np.arcsin(x) + x * np.sqrt(1.0 - x * x))
        return np.where(u < knee, u, value)

    return Built(command_curve(modulated, conditions), {})


@njit(cache=True)
def _programme(c: Array, m: Array, u: Array) -> None:
    """Multiply by a gain m[0] for the limit c[0]; it falls by c[1], returns by c[2] of the way."""
    for k in range(u.shape[0]):
        wanted = min(c[0] / max(u[k], 1e-9), 1.0)
        m[0] += (c[1] if wanted < m[0] else c[2]) * (wanted - m[0])
        u[k] *= m[0]


@reporting(
    "McNally, J. Audio Eng. Soc. 32 (1984) 316: a limiter with times of attack and of release"
)
def programme_limiter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gain that falls for the limit in 0.01 to 0.05 band periods, and returns in 0.1 to 0.6."""
    limit = conditions.high - size * conditions.span
    times = conditions.time * np.array([rng.uniform(0.01, 0.05), rng.uniform(0.1, 0.6)])
    constants = [limit, *-np.expm1(-SUBSTEP / times)]
    return Built(SignalLaw(_programme, constants, [1.0]), {"limit": limit})


@reporting("Hughes, Logarithmic Amplification (1986): stages that limit one after the other")
def limiting_stages(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above a knee two lines, each 2 to 3.5 times less steep and so much longer than the last.

    Both rise by 0.015 to 0.04 travels; then the last stage has reached its limit.
    """
    limit = conditions.top - size * conditions.travel
    ratio, rise = rng.uniform(2.0, 3.5), rng.uniform(0.015, 0.04) * conditions.travel
    ends = rise * np.array([0.0, ratio, ratio + ratio**2])
    law = reading_curve(
        bent_above(limit - 2.0 * rise, lambda d: np.interp(d, ends, rise * np.arange(3.0))),
        conditions,
    )
    return Built(law, {"limit": limit})


@tuning("MacColl, Fundamental Theory of Servomechanisms (1945): a limit that a ripple smooths")
def rippled_limit(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The mean of a reading with a sine of 0.04 to 0.15 travels, cut at the limit."""
    limit = conditions.top - size * conditions.travel
    ripple = rng.uniform(0.04, 0.15) * conditions.travel

    def mean(y: Array) -> Array:
        x = np.clip((limit - y) / ripple, -1.0, 1.0)
        cut = ripple / np.pi * (np.sqrt(1.0 - x * x) - x * np.arccos(x))
        value: Array = np.minimum(y, limit + ripple) - cut
        return value

    return Built(reading_curve(mean, conditions), {"limit": limit})


@reporting("Sullivan, Comput. Music J. 14 (1990) 26: a cubic that ends at the limit")
def cubic_clipper(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above a knee d - 4/27 d³, level at d = 3/2, in units of the 0.03 to 0.1 travels to go."""
    limit = conditions.top - size * conditions.travel
    room = rng.uniform(0.03, 0.1) * conditions.travel

    def cubic(over: Array) -> Array:
        d = np.minimum(over / room, 1.5)
        value: Array = room * (d - 4.0 / 27.0 * d**3)
        return value

    return Built(reading_curve(bent_above(limit - room, cubic), conditions), {"limit": limit})
