"""Stops above a place c[1], which push and never pull."""

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kind import Kind


@njit(cache=True, error_model="numpy")
def hertz_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return Hertz contact with damping that grows with the depth.

    K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440.
    """
    depth = max(y - c[1], 0.0)
    force: float = c[0] * depth**1.5 * max(1.0 + c[2] * v, 0.0)
    return force


HERTZ = Kind(hertz_stop)


@njit(cache=True, error_model="numpy")
def padded_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return a spring and dashpot in parallel that leave the stop without sticking.

    W. Goldsmith, Impact, 1960; L. Johansson's rule that the force never pulls.
    """
    depth = y - c[1]
    return max(c[0] * depth + c[2] * v, 0.0) if depth > 0.0 else 0.0


PADDED = Kind(padded_stop)


@njit(cache=True, error_model="numpy")
def rubber_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return a rubber bumper: its force grows exponentially over the depth c[2].

    P. B. Lindley, Engineering Design with Natural Rubber, 1974.
    """
    depth = max(y - c[1], 0.0) / c[2]
    force: float = c[0] * c[2] * np.expm1(min(depth, 30.0))
    return force


RUBBER = Kind(rubber_stop)


@njit(cache=True, error_model="numpy")
def air_cushion(c: Array, m: Array, y: float, v: float) -> float:
    """Return an air cushion of length c[2], compressed with the exponent 1.4.

    ((1 - d)^-1.4 - 1) c[0] c[2]/1.4, of initial stiffness c[0]; beyond d = 0.95 a straight line.
    """
    d = max(y - c[1], 0.0) / c[2]
    inside = min(d, 0.95)
    force: float = ((1.0 - inside) ** -1.4 - 1.0) / 1.4 + (d - inside) * (1.0 - inside) ** -2.4
    value: float = c[0] * c[2] * force
    return value


CUSHION = Kind(air_cushion)


@njit(cache=True, error_model="numpy")
def stepped_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return a pad of stiffness c[0] and thickness c[2] on a stop of stiffness c[3].

    S. W. Shaw and P. J. Holmes, J. Sound Vib. 90 (1983) 129: a piecewise linear spring.
    """
    depth = max(y - c[1], 0.0)
    value: float = c[0] * min(depth, c[2]) + c[3] * max(depth - c[2], 0.0)
    return value


STEPPED = Kind(stepped_stop)


@njit(cache=True, error_model="numpy")
def disc_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return a disc spring of height c[2] and thickness c[3], with c[4] added once it is flat.

    J. O. Almen and A. László, Trans. ASME 58 (1936) 305: d ((h - d)(h - d/2) + t²), of initial
    stiffness c[0].
    """
    depth = max(y - c[1], 0.0)
    d, square = min(depth, c[2]), c[3] * c[3]
    bent = ((c[2] - d) * (c[2] - 0.5 * d) + square) / (c[2] * c[2] + square)
    value: float = c[0] * d * bent + c[4] * (depth - d)
    return value


DISC = Kind(disc_stop)


@njit(cache=True, error_model="numpy")
def cone_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return c[0] times the square of the depth: I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47."""
    depth = max(y - c[1], 0.0)
    force: float = c[0] * depth * depth
    return force


CONE = Kind(cone_stop)


@njit(cache=True, error_model="numpy")
def dented_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return a stop c[0] that is left along a line c[2] times as steep; m: the largest depth.

    O. R. Walton and R. L. Braun, J. Rheol. 30 (1986) 949.
    """
    depth = max(y - c[1], 0.0)
    back = c[2] * depth - (c[2] - 1.0) * m[0]
    value: float = c[0] * max(min(depth, back), 0.0)
    return value


@njit(cache=True, error_model="numpy")
def carry_dent(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the largest depth."""
    m[0] = max(m[0], y - c[1])


DENTED = Kind(dented_stop, carry_dent)


@njit(cache=True, error_model="numpy")
def wedge_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return a stop c[0] whose force falls to a share c[2] on the way back, c[3] times as steeply.

    V. K. Garg and R. V. Dukkipati, Dynamics of Railway Vehicle Systems, 1984. m: latest force and
    place.
    """
    push = c[0] * max(y - c[1], 0.0)
    value: float = min(max(m[0] + c[3] * c[0] * (y - m[1]), c[2] * push), push)
    return value


@njit(cache=True, error_model="numpy")
def carry_wedges(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry force and place."""
    m[0], m[1] = wedge_stop(c, m, y, v), y


WEDGES = Kind(wedge_stop, carry_wedges)


@njit(cache=True, error_model="numpy")
def creeping_stop(c: Array, m: Array, y: float, v: float) -> float:
    """Return a spring c[0], beside it a spring c[2] on a dashpot that has given way by m[0].

    W. Flügge, Viscoelasticity, 1975. It never pulls.
    """
    depth = max(y - c[1], 0.0)
    value: float = max(c[0] * depth + c[2] * (depth - m[0]), 0.0) if depth > 0.0 else 0.0
    return value


@njit(cache=True, error_model="numpy")
def carry_creeping(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Relax the dashpot by a share c[3] of what is left."""
    m[0] += c[3] * (max(y - c[1], 0.0) - m[0])


CREEPING = Kind(creeping_stop, carry_creeping)
