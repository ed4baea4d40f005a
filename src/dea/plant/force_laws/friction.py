"""Dry friction: bristles, Dahl's solid friction, and forces that depend on the velocity alone."""

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kernels import remembered_force, sliding_force
from dea.plant.force_laws.kind import Kind


@njit(cache=True, error_model="numpy")
def _sliding(c: Array, v: float) -> float:
    """Return the steady force of sliding: c[2] when fast, c[3] when slow, around speed c[4]."""
    force: float = c[2] + (c[3] - c[2]) * np.exp(-((v / c[4]) ** 2))
    return force


@njit(cache=True, error_model="numpy")
def bristle_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the LuGre force: c[0] z + c[1] z'.

    C. Canudas de Wit et al., IEEE Trans. Autom. Control 40 (1995) 419.
    """
    value: float = c[0] * m[0] + c[1] * (v - c[0] * abs(v) * m[0] / _sliding(c, v))
    return value


@njit(cache=True, error_model="numpy")
def carry_bristle(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the bristle deflection, implicitly because it is stiff at high speed."""
    m[0] = (m[0] + v * dt) / (1.0 + c[0] * abs(v) * dt / _sliding(c, v))


LUGRE = Kind(bristle_force, carry_bristle)


@njit(cache=True, error_model="numpy")
def carry_dahl(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry Dahl's force: dF/dy = s (1 - F sign(dy)/F_c) with stiffness s, exactly for a step.

    P. R. Dahl, Aerospace Corp. TOR-0158(3107-18), 1968. c: F_c and s; m: force and latest place.
    """
    step = y - m[1]
    limit = c[0] if step > 0.0 else -c[0]
    m[0] = limit + (m[0] - limit) * np.exp(-c[1] * abs(step) / c[0])
    m[1] = y


DAHL = Kind(remembered_force, carry_dahl)


@njit(cache=True, error_model="numpy")
def stribeck_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return friction that falls with speed: Stribeck's curve as Tustin's exponential.

    B. Armstrong-Hélouvry et al., Automatica 30 (1994) 1083. c: sliding and static force, Stribeck
    speed, speed of regularisation.
    """
    return sliding_force(c[0] + (c[1] - c[0]) * np.exp(-abs(v) / c[2]), v, c[3])


STRIBECK = Kind(stribeck_friction)


@njit(cache=True, error_model="numpy")
def composite_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return a smooth friction of three tanh terms, different in the two directions.

    C. Makkar et al., IEEE/ASME AIM (2005) 600. c: static excess, its two steepnesses, sliding
    force, its steepness, share by which the positive direction is stronger.
    """
    force = c[0] * (np.tanh(c[1] * v) - np.tanh(c[2] * v)) + c[3] * np.tanh(c[4] * v)
    value: float = force * (1.0 + c[5] * np.tanh(c[4] * v))
    return value


COMPOSITE = Kind(composite_friction)


@njit(cache=True, error_model="numpy")
def ageing_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return friction that grows with the logarithm of the age m[0] of the contacts.

    J. H. Dieterich, J. Geophys. Res. 84 (1979) 2161. c: force of new contacts, growth, time of the
    logarithm, length of slip that renews the contacts, speed of regularisation.
    """
    return sliding_force(c[0] * (1.0 + c[1] * np.log1p(m[0] / c[2])), v, c[4])


@njit(cache=True, error_model="numpy")
def carry_age(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the age, which grows with time and falls with slip: a' = 1 - |v| a/c[3], implicitly."""
    m[0] = (m[0] + dt) / (1.0 + abs(v) * dt / c[3])


AGEING = Kind(ageing_friction, carry_age)


@njit(cache=True, error_model="numpy")
def _load(c: Array, y: float) -> float:
    """Return a load c[0] at the place c[2] that grows by c[1] with the place, and never pulls."""
    load: float = max(c[0] + c[1] * (y - c[2]), 0.0)
    return load


@njit(cache=True, error_model="numpy")
def bearing_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return friction in proportion to a load that grows with the place.

    T. A. Harris, Rolling Bearing Analysis, 2001. c: force at the place c[2], its growth with the
    place beyond, speed of regularisation.
    """
    return sliding_force(_load(c, y), v, c[3])


BEARING = Kind(bearing_friction)


@njit(cache=True, error_model="numpy")
def lorentzian_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return friction that falls as 1/(1 + (v/c[2])²) from c[1] to c[0], regularised at c[3].

    D. P. Hess and A. Soom, J. Tribol. 112 (1990) 147.
    """
    ratio = v / c[2]
    return sliding_force(c[0] + (c[1] - c[0]) / (1.0 + ratio * ratio), v, c[3])


LORENTZIAN = Kind(lorentzian_friction)


@njit(cache=True, error_model="numpy")
def running_in_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return friction c[0] of which a share c[1] is lost over a path c[2]; m: the path.

    P. J. Blau, Tribol. Int. 38 (2005) 1007. c[3]: speed of regularisation.
    """
    return sliding_force(c[0] * (1.0 + c[1] * np.expm1(-m[0] / c[2])), v, c[3])


@njit(cache=True, error_model="numpy")
def carry_path(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the path."""
    m[0] += abs(v) * dt


RUNNING_IN = Kind(running_in_friction, carry_path)


@njit(cache=True, error_model="numpy")
def belt_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return what a belt around a post adds to its load, by Euler's exponential.

    J. L. Meriam and L. G. Kraige, Engineering Mechanics: Statics, 2007. c: load at the place c[2],
    its growth with the place beyond, coefficient of friction times angle, speed of regularisation.
    """
    force: float = _load(c, y) * np.expm1(sliding_force(c[3], v, c[4]))
    return force


BELT = Kind(belt_friction)


@njit(cache=True, error_model="numpy")
def uneven_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return friction c[0] that a share c[1] of rises and falls with the place, of period c[2].

    B. Armstrong-Hélouvry, Control of Machines with Friction, 1991. c[3], c[4]: phase, speed of
    regularisation.
    """
    uneven = 1.0 + c[1] * np.sin(2.0 * np.pi * y / c[2] + c[3])
    return sliding_force(c[0] * uneven, v, c[4])


UNEVEN = Kind(uneven_friction)


@njit(cache=True, error_model="numpy")
def carry_bonds(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry bonds of stiffness c[0] that break at the force c[2], and then slide with c[1].

    D. A. Haessig and B. Friedland, J. Dyn. Syst. Meas. Control 113 (1991) 354. m: force, latest
    place, and the side that it slides to, 0 where the bonds hold.
    """
    step = y - m[1]
    m[1] = y
    if m[2] * step > 0.0:
        return
    if step != 0.0:
        m[0], m[2] = m[0] + c[0] * step, 0.0
    if abs(m[0]) >= c[2]:
        m[2] = np.sign(m[0])
        m[0] = c[1] * m[2]


BONDS = Kind(remembered_force, carry_bonds)


@njit(cache=True, error_model="numpy")
def fading_friction(c: Array, m: Array, y: float, v: float) -> float:
    """Return friction c[0] that loses c[1] h/(1 + h) when it is hot by h = m[0].

    T. P. Newcomb and R. T. Spurr, Braking of Road Vehicles, 1967. c[4]: speed of regularisation.
    """
    return sliding_force(c[0] * (1.0 - c[1] * m[0] / (1.0 + m[0])), v, c[4])


@njit(cache=True, error_model="numpy")
def carry_heat(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the heat, which is 1 after long at the speed c[3] and cools in c[2] s."""
    m[0] -= np.expm1(-dt / c[2]) * (abs(v) / c[3] - m[0])


FADING = Kind(fading_friction, carry_heat)
