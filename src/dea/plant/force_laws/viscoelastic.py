"""Forces that relax: spectra of Maxwell elements, and a thermally activated dashpot."""

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kernels import elements_force, relax_elements
from dea.plant.force_laws.kind import Kind


@njit(cache=True, error_model="numpy")
def spectrum_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of c[0] Maxwell elements; (stiffness, share) pairs follow in ``c``.

    The memory holds the dashpots' places; a share is what a dashpot relaxes in a sub-step.
    """
    return elements_force(c[1:], m[: int(c[0])], y)


@njit(cache=True, error_model="numpy")
def carry_spectrum(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Relax every dashpot over a sub-step at a held place, exactly."""
    relax_elements(c[1:], m[: int(c[0])], y)


SPECTRUM = Kind(spectrum_force, carry_spectrum)


@njit(cache=True, error_model="numpy")
def flowing_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a spring c[0] on a dashpot at the place m[0]."""
    force: float = c[0] * (y - m[0])
    return force


@njit(cache=True, error_model="numpy")
def carry_eyring(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry a dashpot whose rate is c[1] sinh(stretch / c[2]), exactly at a held place.

    H. Eyring, J. Chem. Phys. 4 (1936) 283. With z the stretch over c[2], z' = -(c[1]/c[2]) sinh z
    has the solution tanh(z/2) = tanh(z0/2) exp(-c[1] t / c[2]).
    """
    z = (y - m[0]) / c[2]
    z = 2.0 * np.arctanh(np.tanh(0.5 * min(max(z, -30.0), 30.0)) * np.exp(-c[1] / c[2] * dt))
    m[0] = y - c[2] * z


EYRING = Kind(flowing_force, carry_eyring)


@njit(cache=True, error_model="numpy")
def carry_norton(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry a dashpot whose rate is c[1] (stretch/c[2])^c[3], exactly at a held place.

    F. H. Norton, The Creep of Steel at High Temperatures, 1929. With z the stretch over c[2],
    z' = -(c[1]/c[2]) z^n has the solution z = z0 (1 + (n - 1) z0^(n - 1) c[1] t/c[2])^(-1/(n - 1)).
    """
    stretch, order = y - m[0], c[3] - 1.0
    fluid = order * (abs(stretch) / c[2]) ** order * c[1] / c[2] * dt
    m[0] = y - stretch * (1.0 + fluid) ** (-1.0 / order)


NORTON = Kind(flowing_force, carry_norton)


@njit(cache=True, error_model="numpy")
def _elastic(c: Array, y: float) -> float:
    """Return the exponential response c[1] (exp(d/c[1]) - 1) to d = y - c[2]."""
    response: float = c[1] * np.expm1((y - c[2]) / c[1])
    return response


@njit(cache=True, error_model="numpy")
def quasi_linear_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of c[0] elements that relax the elastic response, not the place.

    Y. C. Fung, in Biomechanics: Its Foundations and Objectives, 1972. (Stiffness, share) pairs
    follow the constants of the response; m: what every element has relaxed.
    """
    return elements_force(c[3:], m[: int(c[0])], _elastic(c, y))


@njit(cache=True, error_model="numpy")
def carry_quasi_linear(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Relax every element over a sub-step at a held place, exactly."""
    relax_elements(c[3:], m[: int(c[0])], _elastic(c, y))


QUASI_LINEAR = Kind(quasi_linear_force, carry_quasi_linear)


@njit(cache=True, error_model="numpy")
def carry_reptation(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry Norton's dashpot, ever slower with its own stretch over c[4] from the place c[5].

    J. S. Bergström and M. C. Boyce, J. Mech. Phys. Solids 46 (1998) 931.
    """
    carry_norton(c, m, y, v, dt / (1.0 + abs(m[0] - c[5]) / c[4]))


REPTATION = Kind(flowing_force, carry_reptation)


@njit(cache=True, error_model="numpy")
def free_volume_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of c[0] elements; (stiffness, share of a sub-step) pairs follow c[3]."""
    return elements_force(c[4:], m[: int(c[0])], y)


@njit(cache=True, error_model="numpy")
def carry_free_volume(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Relax every element, exp(c[3] x/(1 + x)) times as quickly at a stretch x over c[1] from c[2].

    W. G. Knauss and I. Emri, Polym. Eng. Sci. 27 (1987) 86, with Doolittle's free volume.
    """
    x = max(y - c[2], 0.0) / c[1]
    quicker = np.exp(c[3] * x / (1.0 + x))
    for i in range(int(c[0])):
        m[i] -= np.expm1(-c[5 + 2 * i] * quicker) * (y - m[i])


FREE_VOLUME = Kind(free_volume_force, carry_free_volume)
