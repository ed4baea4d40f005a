"""Forces of a spring c[0] of which shares are lost: by cycles, strain or work."""

import math

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kernels import lost_force
from dea.plant.force_laws.kind import Kind

POWER, LOGARITHM, SATURATING, STAGES, WEIBULL, PHASES = range(6)


@njit(cache=True, error_model="numpy")
def count_reversals(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Count half cycles: swings longer than c[4], each as its share of the swing c[5].

    m: cycles, extreme of the present swing, its start, direction.
    """
    if m[3] == 0.0:
        m[1], m[2], m[3] = y, y, 1.0
    if (y - m[1]) * m[3] > 0.0:
        m[1] = y
    elif abs(y - m[1]) > c[4]:
        m[0] += 0.5 * min(abs(m[1] - m[2]) / c[5], 1.0)
        m[2], m[1], m[3] = m[1], y, -m[3]


@njit(cache=True, error_model="numpy")
def cycle_damage_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what is lost after m[0] cycles, of the stiffness a share c[1] after c[2] cycles.

    c[6] is the shape: POWER, c[3] of the cycles (O. H. Basquin, Proc. ASTM 10 (1910) 625);
    LOGARITHM; SATURATING, exponentially with c[3] time constants in c[2] cycles (J. Lemaitre and
    J.-L. Chaboche, Mechanics of Solid Materials, 1990); STAGES, c[3] for a share c[7] and c[8] for
    the rest (H. Mao and S. Mahadevan, Compos. Struct. 58 (2002) 405); WEIBULL, as 1 - exp(-n^c[3])
    for n cycles over a share c[7] of c[2] (W. Weibull, J. Appl. Mech. 18 (1951) 293); PHASES, a
    line to c[7] at a share c[3] of the cycles and one from there (S. S. Manson and G. R. Halford,
    Int. J. Fract. 17 (1981) 169).
    """
    cycles = m[0] / c[2]
    lost = 0.0
    if c[6] == POWER:
        lost = cycles ** c[3]
    elif c[6] == LOGARITHM:
        lost = np.log1p(20.0 * cycles) / np.log(21.0)
    elif c[6] == SATURATING:
        lost = np.expm1(-c[3] * cycles) / np.expm1(-c[3])
    elif c[6] == STAGES:
        lost = c[7] * cycles ** c[3] + (1.0 - c[7]) * cycles ** c[8]
    elif c[6] == WEIBULL:
        lost = np.expm1(-((cycles / c[7]) ** c[3])) / np.expm1(-(c[7] ** -c[3]))
    elif c[6] == PHASES:
        first, second = min(cycles, c[3]) / c[3], max(cycles - c[3], 0.0) / (1.0 - c[3])
        lost = c[7] * first + (1.0 - c[7]) * second
    return lost_force(c, y, min(c[1] * lost, 0.9))


CYCLES = Kind(cycle_damage_force, count_reversals)


@njit(cache=True, error_model="numpy")
def pseudo_elastic_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what the Mullins effect takes.

    A share 1 - η = c[1] erf((W_max - W)/(c[2] + c[3] W_max)), W = c[0] y²/2: R. W. Ogden and D. G.
    Roxburgh, Proc. R. Soc. A 455 (1999) 2861.
    """
    work = 0.5 * c[0] * y * y
    most = max(m[0], work)
    return lost_force(c, y, c[1] * math.erf((most - work) / (c[2] + c[3] * most)))


@njit(cache=True, error_model="numpy")
def carry_largest_energy(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the largest energy of a spring c[0] so far."""
    m[0] = max(m[0], 0.5 * c[0] * y * y)


PSEUDO_ELASTIC = Kind(pseudo_elastic_force, carry_largest_energy)


@njit(cache=True, error_model="numpy")
def work_damage_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what is lost with the accumulated work W = m[0], a share c[1] W/(W + c[2]).

    Damage driven by work: J. Lemaitre, J. Eng. Mater. Technol. 107 (1985) 83.
    """
    return lost_force(c, y, c[1] * m[0] / (m[0] + c[2]))


@njit(cache=True, error_model="numpy")
def carry_work(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the work on a spring c[0] without force at c[3], in either direction."""
    m[0] += c[0] * abs((y - c[3]) * v) * dt


WORK = Kind(work_damage_force, carry_work)


@njit(cache=True, error_model="numpy")
def _count_swings(c: Array, m: Array, y: float, least: float) -> None:
    """Count half cycles in m[4], each as its share of the swing c[5] to the power c[6].

    Swings of a share up to ``least`` are not counted.
    """
    before = m[0]
    count_reversals(c, m, y, 0.0, 0.0)
    share = 2.0 * (m[0] - before)
    if share > least:
        m[4] += 0.5 * share ** c[6]


@njit(cache=True, error_model="numpy")
def crack_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what is lost to a crack, a share c[1] when c[3] times as long, after c[2] cycles.

    P. Paris and F. Erdogan, J. Basic Eng. 85 (1963) 528: da/dN is a power c[6] of the swing and
    the root of the length a, so that a^-q falls in a straight line, q = c[6]/2 - 1. After c[2]
    cycles, a motion that the law did not expect, a grows at the rate that it has then.
    """
    q = 0.5 * c[6] - 1.0
    cycles, fall = m[4] / c[2], 1.0 - c[3] ** -q
    length: float = (1.0 - fall * min(cycles, 1.0)) ** (-1.0 / q)
    length += max(cycles - 1.0, 0.0) * fall / q * c[3] ** (1.0 + q)
    return lost_force(c, y, min(c[1] * (length - 1.0) / (c[3] - 1.0), 0.9))


@njit(cache=True, error_model="numpy")
def carry_crack(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Count half cycles."""
    _count_swings(c, m, y, 0.0)


CRACK = Kind(crack_force, carry_crack)


@njit(cache=True, error_model="numpy")
def miner_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what is lost, a share c[1] after c[2] cycles.

    M. A. Miner, J. Appl. Mech. 12 (1945) A159.
    """
    return lost_force(c, y, min(c[1] * m[4] / c[2], 0.9))


@njit(cache=True, error_model="numpy")
def carry_miner(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Count half cycles above a share c[3]."""
    _count_swings(c, m, y, c[3])


MINER = Kind(miner_force, carry_miner)


@njit(cache=True, error_model="numpy")
def carry_strain_work(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the largest energy of a spring c[0] so far, and the sum of all its changes.

    c[5]: place without force; m: largest, sum and latest energy.
    """
    energy = 0.5 * c[0] * (y - c[5]) ** 2
    m[0], m[1], m[2] = max(m[0], energy), m[1] + abs(energy - m[2]), energy


@njit(cache=True, error_model="numpy")
def two_damages_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what is lost, shares c[1] with the largest energy and c[3] with all its changes.

    C. Miehe, Eur. J. Mech. A/Solids 14 (1995) 697: either is an exponential, over c[2] and c[4].
    """
    lost = -c[1] * np.expm1(-m[0] / c[2]) - c[3] * np.expm1(-m[1] / c[4])
    return lost_force(c, y, min(lost, 0.9))


TWO_DAMAGES = Kind(two_damages_force, carry_strain_work)


@njit(cache=True, error_model="numpy")
def carry_filler(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the share m[0] of contacts that a path c[2] breaks, and that join again in c[3] s.

    G. Kraus, J. Appl. Polym. Sci. Appl. Polym. Symp. 39 (1984) 75; exactly at a held speed.
    """
    breaking, joining = abs(v) / c[2], 1.0 / c[3]
    both = breaking + joining
    m[0] -= np.expm1(-both * dt) * (breaking / both - m[0])


@njit(cache=True, error_model="numpy")
def filler_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what is lost, a share c[1] where every contact is broken."""
    return lost_force(c, y, min(c[1] * m[0], 0.9))


FILLER = Kind(filler_force, carry_filler)
