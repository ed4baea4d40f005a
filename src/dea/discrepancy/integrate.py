"""One compiled integrator for every simulation and every force-balance effect.

Simulations and effects enter as first-class functions of fixed signatures, so that neither a new
effect nor a new parameter compiles anything.
"""

import warnings
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import float64, int64, njit, types
from numba.core.errors import NumbaExperimentalFeatureWarning
from numba.extending import typeof_impl

# First-class functions are what keeps this to one compilation.
warnings.filterwarnings("ignore", category=NumbaExperimentalFeatureWarning)

_VECTOR = types.Array(float64, 1, "C")
_MATRIX = types.Array(float64, 2, "C")
_INDEX = types.Array(int64, 2, "C")
DERIVATIVE = types.void(_VECTOR, float64, _VECTOR, _VECTOR)
OUTPUT = float64(_VECTOR, float64, _VECTOR)
FORCE = float64(float64, float64, _VECTOR, _VECTOR)
UPDATE = types.void(float64, float64, float64, _VECTOR, _VECTOR)

SLOTS = 3
MEMORY = 12


def compiled(function: Callable[..., Any], signature: Any) -> Any:
    """Compile ``function`` for ``signature``, unless it is compiled just so."""
    options = getattr(function, "targetoptions", {})
    made_for = [str(own) for own in getattr(function, "nopython_signatures", ())]
    if options.get("error_model") == "numpy" and made_for == [str(signature)]:
        return function
    # Divisions by zero give infinities, which are data; an exception would not be.
    return njit(signature, error_model="numpy")(getattr(function, "py_func", function))


class FirstClass(types.WrapperAddressProtocol):
    """A compiled function as an argument of another one, its address and type looked up once.

    Numba looks up those of a plain one at every call, which takes longer than a short record
    does. An exception would not leave such a function.
    """

    def __init__(self, function: Any) -> None:
        self._function = function
        (self._signature,) = function.nopython_signatures
        result = function.get_compile_result(self._signature)
        self._address = result.library.get_pointer_to_function(
            result.fndesc.llvm_cfunc_wrapper_name
        )
        self.numba_type = types.FunctionType(self._signature)

    def __wrapper_address__(self) -> int:
        return self._address

    def signature(self) -> Any:
        """Return the signature the function is compiled for."""
        return self._signature


@typeof_impl.register(FirstClass)
def _type_of(function: FirstClass, context: Any) -> types.FunctionType:
    return function.numba_type


first_class = cache(FirstClass)


@njit(FORCE, cache=True)
def no_force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Fill an empty slot."""
    return 0.0


@njit(UPDATE, cache=True)
def no_update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Fill the slot of a force without memory."""


@njit(inline="always")
def _positions(x, ports, frames, z):
    """Write the normalised position of each port that has one."""
    for e in range(SLOTS + 1):
        if ports[e, 1] >= 0:
            z[e] = (x[ports[e, 1]] - frames[e, 0]) / frames[e, 1]


_F, _U = types.FunctionType(FORCE), types.FunctionType(UPDATE)


@njit(types.void(_MATRIX, _VECTOR, _VECTOR, float64, _VECTOR), cache=True)
def _advance_two(J, slope, ramp, h, step):
    """Write h φ₁(h J) f + h φ₂(h J) Δf for two states, interpolated at the eigenvalues of h J."""
    a, b, c, d = h * J[0, 0], h * J[0, 1], h * J[1, 0], h * J[1, 1]
    middle = 0.5 * (a + d)
    square = 0.25 * (a - d) ** 2 + b * c
    apart = max(np.sqrt(abs(square)), 1e-4)
    if square >= 0.0:
        first, second = middle + apart, middle - apart
        f1 = np.expm1(first) / first if abs(first) > 1e-8 else 1.0
        f2 = np.expm1(second) / second if abs(second) > 1e-8 else 1.0
        g1 = (f1 - 1.0) / first if abs(first) > 1e-4 else 0.5 + first / 6.0
        g2 = (f2 - 1.0) / second if abs(second) > 1e-4 else 0.5 + second / 6.0
        slope_1, slope_2 = (f1 - f2) / (2.0 * apart), (g1 - g2) / (2.0 * apart)
        constant_1, constant_2 = f1 - slope_1 * first, g1 - slope_2 * first
    else:
        # φ₁ and φ₂ at the complex pair middle ± i apart, in real and imaginary parts.
        growth, radius = np.exp(middle), middle * middle + apart * apart
        real, imaginary = growth * np.cos(apart) - 1.0, growth * np.sin(apart)
        real_1 = (real * middle + imaginary * apart) / radius
        imaginary_1 = (imaginary * middle - real * apart) / radius
        real_2 = ((real_1 - 1.0) * middle + imaginary_1 * apart) / radius
        imaginary_2 = (imaginary_1 * middle - (real_1 - 1.0) * apart) / radius
        slope_1, slope_2 = imaginary_1 / apart, imaginary_2 / apart
        constant_1, constant_2 = real_1 - slope_1 * middle, real_2 - slope_2 * middle
    f, g, up, to = slope[0], slope[1], ramp[0], ramp[1]
    step[0] = h * (constant_1 * f + slope_1 * (a * f + b * g))
    step[1] = h * (constant_1 * g + slope_1 * (c * f + d * g))
    step[0] += h * (constant_2 * up + slope_2 * (a * up + b * to))
    step[1] += h * (constant_2 * to + slope_2 * (c * up + d * to))


@njit(_MATRIX(_MATRIX, _MATRIX), cache=True)
def _product(A, B):
    n = A.shape[0]
    C = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            for k in range(n):
                C[i, j] += A[i, k] * B[k, j]
    return C


@njit(types.void(_MATRIX, _VECTOR, _VECTOR, float64, _VECTOR), cache=True)
def _advance(J, slope, ramp, h, step):
    """Write h φ₁(h J) f + h φ₂(h J) Δf by Taylor series of a halved step, doubled back.

    Higham 2008, section 10.7.4.
    """
    n = slope.size
    size = 0.0
    for i in range(n):
        row = 0.0
        for j in range(n):
            row += abs(h * J[i, j])
        size = max(size, row)
    doublings = 0
    while size > 0.5 and doublings < 60:
        size *= 0.5
        doublings += 1
    A = J * (h * 0.5**doublings)
    identity = np.eye(n)
    phi, phi_2, term = identity.copy(), 0.5 * identity, identity.copy()
    for k in range(2, 11):
        term = _product(term, A) / k
        phi += term
        phi_2 += term / (k + 1)
    exponential = identity + _product(A, phi)
    for _ in range(doublings):
        phi_2 = 0.25 * (_product(phi, phi) + 2.0 * phi_2)
        phi = 0.5 * _product(exponential + identity, phi)
        exponential = _product(exponential, exponential)
    for i in range(n):
        step[i] = 0.0
        for j in range(n):
            step[i] += h * (phi[i, j] * slope[j] + phi_2[i, j] * ramp[j])


@njit(
    _MATRIX(
        types.FunctionType(DERIVATIVE), types.FunctionType(OUTPUT), _F, _U, _F, _U, _F, _U, int64,
        _VECTOR, _VECTOR, int64, _VECTOR, int64, _VECTOR, _VECTOR, float64, int64,
        _INDEX, _MATRIX, _MATRIX, _MATRIX,
    ),
    cache=True,
    nogil=True,
)  # fmt: skip
def integrate(
    derivative,
    output,
    force_1,
    update_1,
    force_2,
    update_2,
    force_3,
    update_3,
    forces,
    u,
    course,
    straight,
    p,
    drive,
    drive_scale,
    x0,
    interval,
    substeps,
    ports,
    frames,
    memory,
    q,
):
    """Integrate by the exponential Rosenbrock-Euler method with steps of ``interval/substeps``.

    The method is exact for a linear simulation under an input that is held, or straight between
    samples, however stiff, and of second order otherwise (Hochbruck and Ostermann 2010, Acta
    Numerica 19:209, sections 2.4 and 3.4 with the change of the input over the step). Effects with
    memory are split off (Strang 1968): within a step the force is evaluated with the memory of
    the step's middle, which is then brought forward by the motion over the step.

    Parameters
    ----------
    u : (n,)
        Input at each sample, which the output may depend on.
    course : (n substeps + 1,)
        Input at the start of each step and at the end of the last; held over a step, or
        ``straight`` from one to the next.
    drive, drive_scale : int, (n,)
        Index of the parameter that is multiplied by ``drive_scale`` at each sample.
    ports : (SLOTS + 1, 4)
        States that are balance, position, velocity and reaction of each force (-1: there is
        none); the last row is the port whose position is returned.
    frames : (SLOTS + 1, 3)
        Rest position and scale of each port's motion, and the balance's change per unit of force.
    memory, q : (SLOTS, MEMORY), (SLOTS, parameters)
        Memory (changed in place) and parameters of each force.

    Returns
    -------
    (2, n)
        Output, and the normalised position, at each sample; NaN from where the states run away.
    """
    n, states = u.size, x0.size
    result = np.full((2, n), np.nan)
    x, moved, step = x0.copy(), np.empty(states), np.empty(states)
    slope, beside, ramp = np.empty(states), np.empty(states), np.zeros(states)
    pushes, J = np.zeros(SLOTS), np.empty((states, states))
    typical = np.abs(x0) + 1e-6
    p = p.copy()
    p_drive = p[drive]
    # Rows are cut out once: cutting them in the loop costs more than the forces do.
    m1, m2, m3 = memory[0], memory[1], memory[2]
    q1, q2, q3 = q[0], q[1], q[2]
    h = interval / substeps
    z, z_next = np.zeros(SLOTS + 1), np.zeros(SLOTS + 1)
    # Memories are kept half a step ahead, which makes the splitting one of second order.
    _positions(x, ports, frames, z)
    if forces:
        update_1(z[0], z[0], 0.5 * h, m1, q1)
        if forces > 1:
            update_2(z[1], z[1], 0.5 * h, m2, q2)
        if forces > 2:
            update_3(z[2], z[2], 0.5 * h, m3, q3)
    for i in range(n):
        p[drive] = p_drive * drive_scale[i]
        _positions(x, ports, frames, z)
        result[0, i] = output(x, u[i], p)
        result[1, i] = z[SLOTS]
        for s in range(substeps):
            v = course[i * substeps + s]
            # Column 0 is the slope at x; column j that beside it in state j - 1.
            for column in range(states + 1):
                nudge = 0.0
                for j in range(states):
                    moved[j] = x[j]
                if column:
                    typical[column - 1] = max(typical[column - 1], abs(x[column - 1]))
                    nudge = 1e-6 * typical[column - 1]
                    # Where a force looks at the position, the secant over the coming motion
                    # sees the corners of its law.
                    for e in range(forces):
                        if ports[e, 1] == column - 1 and abs(h * slope[column - 1]) > nudge:
                            nudge = h * slope[column - 1]
                    moved[column - 1] += nudge
                derivative(moved, v, p, beside)
                for e in range(forces):
                    position, velocity = ports[e, 1], ports[e, 2]
                    rest, scale = frames[e, 0], frames[e, 1]
                    at = (moved[position] - rest) / scale if position >= 0 else z[e]
                    w = (moved[velocity] if velocity >= 0 else beside[position]) / scale
                    if e == 0:
                        push = force_1(at, w, m1, q1)
                    elif e == 1:
                        push = force_2(at, w, m2, q2)
                    else:
                        push = force_3(at, w, m3, q3)
                    pushes[e] = frames[e, 2] * push
                for e in range(forces):
                    beside[ports[e, 0]] += pushes[e]
                    if ports[e, 3] >= 0:
                        beside[ports[e, 3]] -= pushes[e]
                for j in range(states):
                    if column:
                        J[j, column - 1] = (beside[j] - slope[j]) / nudge
                    else:
                        slope[j] = beside[j]
            if straight:
                derivative(x, v, p, moved)
                derivative(x, course[i * substeps + s + 1], p, beside)
                for j in range(states):
                    ramp[j] = beside[j] - moved[j]
            if states == 2:
                _advance_two(J, slope, ramp, h, step)
            else:
                _advance(J, slope, ramp, h, step)
            for e in range(forces):
                if ports[e, 1] < 0:
                    z_next[e] = z[e] + h * (x[ports[e, 2]] + 0.5 * step[ports[e, 2]]) / frames[e, 1]
            for j in range(states):
                x[j] += step[j]
            if forces:
                _positions(x, ports, frames, z_next)
                update_1(z[0], z_next[0], h, m1, q1)
                if forces > 1:
                    update_2(z[1], z_next[1], h, m2, q2)
                if forces > 2:
                    update_3(z[2], z_next[2], h, m3, q3)
                for e in range(SLOTS):
                    z[e] = z_next[e]
        for j in range(states):
            if not abs(x[j]) < 1e12:
                return result
    return result
