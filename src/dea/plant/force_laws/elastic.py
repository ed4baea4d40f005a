"""Elastic forces that are functions of the place alone."""

import math

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kind import Kind


@njit(cache=True, error_model="numpy")
def fung_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return c[0] (exp(x) - 1 - x), x = (y - c[2])/c[1]: Y. C. Fung, Biomechanics, 1981."""
    x = (y - c[2]) / c[1]
    force: float = c[0] * (np.exp(x) - 1.0 - x)
    return force


FUNG = Kind(fung_force)


@njit(cache=True, error_model="numpy")
def gent_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what limited chains add to a spring: c[0] d (1/(1 - (d/c[1])²) - 1).

    d = y - c[2] > 0. A. N. Gent, Rubber Chem. Technol. 69 (1996) 59.
    Beyond 0.99 c[1] it goes on in a straight line.
    """
    x = max(y - c[2], 0.0) / c[1]
    inside = min(x, 0.99)
    stiff = 1.0 / (1.0 - inside * inside)
    force: float = c[0] * c[1] * (inside * (stiff - 1.0))
    value: float = force + c[0] * c[1] * (x - inside) * (
        stiff * stiff * (1.0 + inside * inside) - 1.0
    )
    return value


GENT = Kind(gent_force)


@njit(cache=True, error_model="numpy")
def chain_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what a freely jointed chain adds to its own initial stiffness c[0].

    The inverse Langevin function in Cohen's approximation x (3 - x²)/(1 - x²), less 3x, with
    x = (y - c[2])/c[1] (A. Cohen, Rheol. Acta 30 (1991) 270; E. M. Arruda and M. C. Boyce, J. Mech.
    Phys. Solids 41 (1993) 389). From x = 0.99 on it is constant.
    """
    x = min(max(y - c[2], 0.0) / c[1], 0.99)
    force: float = c[0] * c[1] * (x * (3.0 - x * x) / (1.0 - x * x) / 3.0 - x)
    return force


CHAIN = Kind(chain_force)


@njit(cache=True, error_model="numpy")
def power_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return c[0] d^c[1] for d = (y - c[2])/c[3] > 0: one term of R. W. Ogden's series (1972)."""
    d = max(y - c[2], 0.0) / c[3]
    force: float = c[0] * d ** c[1]
    return force


POWER = Kind(power_force)


@njit(cache=True, error_model="numpy")
def snap_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a buckled strip, unstable at its middle c[1], of width c[2]."""
    place = (y - c[1]) / c[2]
    force: float = -c[0] * np.sin(2.0 * np.pi * place) * np.exp(-place * place)
    return force


SNAP_THROUGH = Kind(snap_force)


@njit(cache=True, error_model="numpy")
def demiray_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return c[0] x (exp(x²) - 1) for x = (y - c[2])/c[1] > 0.

    H. Demiray, J. Biomech. 5 (1972) 309: an energy exponential in the squared stretch, here less
    the stiffness that it has at rest.
    """
    x = min(max(y - c[2], 0.0) / c[1], 6.0)
    force: float = c[0] * x * np.expm1(x * x)
    return force


DEMIRAY = Kind(demiray_force)


@njit(cache=True, error_model="numpy")
def fibre_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of fibres c[0] that become taut one after the other.

    Y. Lanir, J. Biomech. 16 (1983) 1. The places where they do have the mean c[1] and the standard
    deviation c[2] of a Gaussian.
    """
    x = (y - c[1]) / c[2]
    taut = 0.5 * (1.0 + math.erf(x / np.sqrt(2.0)))
    force: float = c[0] * c[2] * (x * taut + np.exp(-0.5 * x * x) / np.sqrt(2.0 * np.pi))
    return force


FIBRES = Kind(fibre_force)


@njit(cache=True, error_model="numpy")
def cable_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the pull of cables across the motion, straight and without tension at place c[2].

    c[0] d (1 - h/√(d² + h²)), d = y - c[2] > 0, h = c[1] the half span: H. M. Irvine, Cable
    Structures, 1981.
    """
    d = max(y - c[2], 0.0)
    force: float = c[0] * d * (1.0 - c[1] / np.hypot(d, c[1]))
    return force


CABLES = Kind(cable_force)


@njit(cache=True, error_model="numpy")
def toe_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return c[0] (exp(d/c[1]) - 1) for d = y - c[2] > 0, and its tangent beyond d = c[3].

    J. A. Weiss et al., Comput. Methods Appl. Mech. Eng. 135 (1996) 107.
    """
    d = max(y - c[2], 0.0)
    inside = min(d, c[3])
    grown = np.exp(inside / c[1])
    force: float = c[0] * (grown - 1.0 + (d - inside) / c[1] * grown)
    return force


TOE = Kind(toe_force)


@njit(cache=True, error_model="numpy")
def conical_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what solid coils add to the force of a conical spring, wound from 1 down to c[3].

    E. Rodriguez et al., J. Mech. Des. 128 (2006) 1352. With the force c[0] at which the widest coil
    is solid, its room c[1] as length and c[2] as place without force, coils wider than x are solid
    at the force x^-3 and at the depth d = 1 - 3x/4 - q^4/(4x^3), q = c[3]. Where 0.95 of the way
    is over on which coils become solid, it goes on in a straight line.
    """
    d, q = max(y - c[2], 0.0) / c[1], c[3]
    begun = 0.25 * (1.0 - q**4)
    inside = min(d, begun + 0.95 * (1.0 - q - begun))
    if inside <= begun:
        return 0.0
    x = 1.0
    for _ in range(12):  # Newton's rule for the largest root, from above
        x -= (3.0 * x - 4.0 * (1.0 - inside) + q**4 / x**3) / (12.0 * (1.0 - (1.0 - inside) / x))
    added = x**-3 - inside / begun + (d - inside) * (4.0 / (x**4 - q**4) - 1.0 / begun)
    force: float = c[0] * added
    return force


CONICAL = Kind(conical_force)


@njit(cache=True, error_model="numpy")
def guided_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return what a curved guide adds to a leaf spring that lays itself against it.

    J. P. Den Hartog, Mechanical Vibrations, 1956. At the place c[2] the leaf, deflected by c[1],
    first touches with its root, under the force c[0]; at x deflections the part that is still free
    needs 1/√(3 - 2x) of that force. From 1.47 on it goes on in a straight line.
    """
    x = 1.0 + max(y - c[2], 0.0) / c[1]
    inside = min(x, 1.47)
    room = 3.0 - 2.0 * inside
    added = room**-0.5 - inside + (x - inside) * (room**-1.5 - 1.0)
    force: float = c[0] * added
    return force


GUIDED = Kind(guided_force)


@njit(cache=True, error_model="numpy")
def nested_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of three springs c[0] from the places c[1:4] on: A. M. Wahl, 1963."""
    force = 0.0
    for i in range(1, 4):
        force += c[0] * max(y - c[i], 0.0)
    return force


NESTED = Kind(nested_force)


@njit(cache=True, error_model="numpy")
def worm_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return c[0] (1/(1 - x)² - 1 - 2x) for x = (y - c[2])/c[1] > 0, and a line beyond 0.95.

    J. F. Marko and E. D. Siggia, Macromolecules 28 (1995) 8759: four times the interpolated force
    of a chain, less its first stiffness.
    """
    x = max(y - c[2], 0.0) / c[1]
    inside = min(x, 0.95)
    left = 1.0 / (1.0 - inside)
    force: float = c[0] * (
        left * left - 1.0 - 2.0 * inside + (x - inside) * 2.0 * (left * left * left - 1.0)
    )
    return force


WORM = Kind(worm_force)
