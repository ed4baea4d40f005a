"""Forces that change with time, whatever the motion."""

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kernels import carry_time, lost_force
from dea.plant.force_laws.kind import Kind

(
    POWER,
    EXPONENTIALS,
    LOGARITHM,
    PELEG,
    SIGMOID,
    SETTLING,
    DRAINING,
    RAMP,
    STRETCHED,
    INDUCTION,
) = range(10)


@njit(cache=True, error_model="numpy")
def course(shape: float, a: float, b: float, t: float) -> float:
    """Return a change that begins at 0, over time ``t`` (s).

    POWER: 1 - (1 + t/a)^-b; EXPONENTIALS: of time constants a and b, equal shares; LOGARITHM:
    ln(1 + t/a)/ln(1 + b/a), 1 at time b; PELEG: t/(a + t) (M. Peleg, J. Food Sci. 44 (1979) 277);
    SIGMOID: logistic at a of width b; SETTLING: exponential after a with time constant b;
    DRAINING: with one exponential of the root of t/a and one of t/a (Y. Hu et al., Appl. Phys.
    Lett. 96 (2010) 121904, a sphere); RAMP: a straight line from a over b; STRETCHED: exponential
    in (t/a)^b (R. Kohlrausch, Ann. Phys. 91 (1854) 179); INDUCTION: an exponential with time
    constant b of the integral of a logistic at a of width a/5 (J. Scanlan and W. F. Watson, Trans.
    Faraday Soc. 54 (1958) 740).
    """
    value: float = 0.0
    if shape == POWER:
        value = 1.0 - (1.0 + t / a) ** -b
    elif shape == EXPONENTIALS:
        value = 1.0 - 0.5 * (np.exp(-t / a) + np.exp(-t / b))
    elif shape == LOGARITHM:
        value = np.log1p(t / a) / np.log1p(b / a)
    elif shape == PELEG:
        value = t / (a + t)
    elif shape == SIGMOID:
        value = 1.0 / (1.0 + np.exp(-min(max((t - a) / b, -500.0), 500.0)))
    elif shape == SETTLING:
        value = -np.expm1(-max(t - a, 0.0) / b)
    elif shape == DRAINING:
        x = t / a
        value = 1.0 - 0.491 * np.exp(-0.908 * np.sqrt(x)) - 0.509 * np.exp(-1.679 * x)
    elif shape == RAMP:
        value = min(max((t - a) / b, 0.0), 1.0)
    elif shape == STRETCHED:
        value = -np.expm1(-((t / a) ** b))
    elif shape == INDUCTION:
        cut = np.logaddexp(0.0, 5.0 * (t - a) / a) - np.logaddexp(0.0, -5.0)
        value = -np.expm1(-0.2 * a / b * cut)
    return value


@njit(cache=True, error_model="numpy")
def stiffness_in_time(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a stiffness c[0] that comes (or goes, where negative) with time."""
    value: float = c[0] * y * course(c[1], c[2], c[3], m[0])
    return value


STIFFNESS_COURSE = Kind(stiffness_in_time, carry_time)


@njit(cache=True, error_model="numpy")
def force_in_time(c: Array, m: Array, y: float, v: float) -> float:
    """Return a force of height c[0] that comes with time."""
    value: float = c[0] * course(c[1], c[2], c[3], m[0])
    return value


FORCE_COURSE = Kind(force_in_time, carry_time)


@njit(cache=True, error_model="numpy")
def pulse_train(c: Array, m: Array, y: float, v: float) -> float:
    """Return equal pulses of mean 0: a von Mises bell of concentration c[3], c[1] a second."""
    bell = np.exp(c[3] * (np.cos(2.0 * np.pi * c[1] * m[0] + c[2]) - 1.0))
    force: float = c[0] * (bell - c[4])
    return force


PULSES = Kind(pulse_train, carry_time)


@njit(cache=True, error_model="numpy")
def dashpot_in_time(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a dashpot c[0] that comes with time."""
    value: float = c[0] * v * course(c[1], c[2], c[3], m[0])
    return value


DASHPOT_COURSE = Kind(dashpot_in_time, carry_time)


@njit(cache=True, error_model="numpy")
def softening_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what a spring c[0] loses with the share m[1] of its stiffness."""
    return lost_force(c, y, m[1])


@njit(cache=True, error_model="numpy")
def carry_relaxing(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the share m[1] lost by c[1] elements; (weight, time constant) pairs follow; m[0]: time.

    R. C. Koeller, J. Appl. Mech. 51 (1984) 299: by the spectrum of Mittag-Leffler's function.
    """
    m[0] += dt
    lost = 0.0
    for i in range(int(c[1])):
        lost -= c[2 + 2 * i] * np.expm1(-m[0] / c[3 + 2 * i])
    m[1] = lost


RELAXING = Kind(softening_force, carry_relaxing)


@njit(cache=True, error_model="numpy")
def carry_reduced_time(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the share m[1] lost exponentially, c[1] s, by a clock whose rate swings; m[0]: time.

    L. W. Morland and E. H. Lee, Trans. Soc. Rheol. 4 (1960) 233. The rate is
    1 + c[4] sin(c[2] t + c[3]).
    """
    m[0] += dt
    reduced = m[0] + c[4] / c[2] * (np.cos(c[3]) - np.cos(c[2] * m[0] + c[3]))
    m[1] = -np.expm1(-reduced / c[1])


REDUCED_TIME = Kind(softening_force, carry_reduced_time)
