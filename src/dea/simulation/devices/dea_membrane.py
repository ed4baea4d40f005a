"""A dielectric elastomer membrane, electroded at its centre, that carries a mass: elastic film.

The prestretched film is clamped at the frame and electroded out to a radius a; under voltage the
electroded disc grows by an in-plane stretch x at the cost of the passive annulus around it. The
annulus deforms as a linear elastic one, u = α (R − b²/R) with u(a) = (x − 1) a; x makes the virtual
work of the true stresses and of the Maxwell stress vanish. The mass hangs on the tensions that
result: a cone of slope F/(2π r N). An incompressible Yeoh film, an ideal amplifier and sensor, one
dashpot. Wissler and Mazza (2007), Sensors and Actuators A 134:494, for the film; Suo (2010), Acta
Mechanica Solida Sinica 23:549, for the field.
"""

from math import inf, log, nan, pi, sqrt

import numpy as np
from numba import njit

from dea.simulation.cubic import weights
from dea.simulation.force_port import ForcePort
from dea.simulation.input_action import InputAction
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT, VECTOR
from dea.simulation.simulation import Simulation
from dea.simulation.state import State

VACUUM_PERMITTIVITY = 8.8541878128e-12
GRAVITY = 9.80665
# Three Gauss-Legendre points in ln R across the annulus: the first, from 0 to 1, and the weights.
POINT = 0.1127016653792583
WEIGHTS = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)
TRIES = 40
# A root is found where stretches differ by less than CLOSE and the remaining stress is below FLAT
# times the modulus. FAR is the step of the search where the interpolation does not converge.
CLOSE, FLAT, FAR = 1e-7, 1e-4, 0.02
# Nodes of the table of stiffnesses, and those next to pull-in between which none is interpolated.
NODES, NEAR_PULL_IN = 256, 16


@njit(cache=True, error_model="numpy")
def work(
    x: float, u: float, p: np.ndarray, squares: tuple[float, float, float, float, float]
) -> tuple[float, float, float]:
    """Return the virtual work that resists dx, the disc's stress, and the annulus's ∫ dr/(r N).

    The work, over 2π, a² and the thickness h of the prestretched film, and the stress are in Pa;
    the integral is times h, in 1/Pa. ``squares`` are R²/a² at the points and at the frame, and
    ln b/a. NaN where the disc is slack or the annulus crushed. A film of true stress σ and
    stretches λ does the work σ₁ δλ₁/λ₁ + σ₂ δλ₂/λ₂ per volume; its tension is σ₁ times its
    thickness.
    """
    c10, c20, c30, prestretch, epsilon_r = p[2], p[3], p[4], p[5], p[6]
    thickness, gain = p[10], p[11]
    outer = squares[3]
    give = 1.0 / (outer - 1.0)
    initial = prestretch * prestretch
    square = initial * x * x
    contraction = 1.0 / (square * square)
    invariant = 2.0 * square + contraction - 3.0
    W = c10 + invariant * (2.0 * c20 + 3.0 * c30 * invariant)
    field = gain * u * square / thickness
    sigma = 2.0 * W * (square - contraction)
    sigma -= VACUUM_PERMITTIVITY * epsilon_r * field * field
    if not (sigma > 0.0 and (x - 1.0) * (outer + 1.0) < outer - 1.0):
        return nan, nan, nan
    resisting, compliance = sigma / x, 0.0
    for k in range(3):
        grown = squares[k]
        squared = outer / grown
        radial, hoop = -give * (squared + 1.0), give * (squared - 1.0)
        along, around = 1.0 + radial * (x - 1.0), 1.0 + hoop * (x - 1.0)
        square_1, square_2 = initial * along * along, initial * around * around
        contraction = 1.0 / (square_1 * square_2)
        invariant = square_1 + square_2 + contraction - 3.0
        W = c10 + invariant * (2.0 * c20 + 3.0 * c30 * invariant)
        sigma_1, sigma_2 = 2.0 * W * (square_1 - contraction), 2.0 * W * (square_2 - contraction)
        weight = WEIGHTS[k] * squares[4]
        resisting += weight * grown * (radial * sigma_1 / along + hoop * sigma_2 / around)
        compliance += weight * along * along / sigma_1
    return resisting, sigma, compliance


@njit(cache=True, error_model="numpy")
def squares_of(p: np.ndarray) -> tuple[float, float, float, float, float]:
    """Return R²/a² at the points and at the frame, and ln b/a."""
    ratio = p[7] / p[8]
    outer = ratio * ratio
    inner = outer**POINT
    return inner, ratio, outer / inner, outer, 0.5 * log(outer)


@njit(cache=True, error_model="numpy")
def suspending(x: float, sigma: float, compliance: float, p: np.ndarray) -> float:
    """Return the vertical stiffness in N/m at a stretch, given what :func:`work` returns."""
    compliance += log(p[8] * x / p[9]) * x * x / sigma
    return float(2.0 * pi / compliance * p[10] / (p[5] * p[5]))


@njit(cache=True, error_model="numpy")
def stiffness(u: float, p: np.ndarray) -> float:
    """Return the vertical stiffness in N/m, NaN beyond pull-in.

    x is found by inverse quadratic interpolation from estimates below it, of which the first is
    that of a neo-Hookean film: where the work is concave in x, it stays on this side of pull-in.
    Elsewhere x is looked for from 1 outwards.
    """
    initial, squares = p[5] * p[5], squares_of(p)
    outer = squares[3]
    invariant = 2.0 * initial - 3.0
    W = p[2] + invariant * (2.0 * p[3] + 3.0 * p[4] * invariant)
    field = p[11] * u * initial / p[10]
    pressure = VACUUM_PERMITTIVITY * p[6] * field * field
    growth = pressure / (4.0 * W * initial * outer / (outer - 1.0)) + 1e-4
    x_0, x_1 = 1.0, 1.0 + min(growth * (1.0 + 3.0 * growth), 0.2)
    work_0, work_1 = -pressure, work(x_1, u, p, squares)[0]
    x_2 = x_1 - work_1 * (x_1 - x_0) / (work_1 - work_0)
    for _ in range(TRIES):
        work_2, sigma, compliance = work(x_2, u, p, squares)
        d_01, d_02, d_12 = work_0 - work_1, work_0 - work_2, work_1 - work_2
        x_3 = x_0 * work_1 * work_2 / (d_01 * d_02)
        x_3 -= x_1 * work_0 * work_2 / (d_01 * d_12)
        x_3 += x_2 * work_0 * work_1 / (d_02 * d_12)
        if abs(x_3 - x_2) < CLOSE and abs(work_2) < FLAT * W:
            return suspending(x_2, sigma, compliance, p)
        x_0, x_1, x_2 = x_1, x_2, x_3
        work_0, work_1 = work_1, work_2
    return searched(u, p, squares)


@njit(cache=True, error_model="numpy")
def searched(u: float, p: np.ndarray, squares: tuple[float, float, float, float, float]) -> float:
    """Return the stiffness at the first stretch that is resisted, NaN where none is.

    A slack disc grows, and the annulus is crushed at the largest stretch.
    """
    below = above = 1.0
    largest = 1.0 + (squares[3] - 1.0) / (squares[3] + 1.0) - CLOSE
    while not work(above, u, p, squares)[0] > 0.0:
        if above >= largest:
            return nan
        below, above = above, min(above + FAR, largest)
    while above - below > CLOSE:
        middle = 0.5 * (below + above)
        if work(middle, u, p, squares)[0] > 0.0:
            above = middle
        else:
            below = middle
    _, sigma, compliance = work(above, u, p, squares)
    return suspending(above, sigma, compliance, p)


@njit(VECTOR(VECTOR, VECTOR, VECTOR), cache=True, nogil=True, error_model="numpy")
def stiffnesses(u: np.ndarray, scale: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return the vertical stiffness (m,) in N/m at voltages ``u`` (m,), NaN beyond pull-in.

    The permittivity is that in ``p`` times ``scale`` (m,). It acts together with the square of the
    voltage, in equal steps of which the stiffness is tabulated and interpolated by cubics.
    """
    pull = scale * u * u
    low, high = pull.min(), pull.max()
    spacing = (high - low) / (NODES - 3)
    result, nodes = np.empty(u.size), np.empty(NODES)
    tabulated = u.size > NODES and spacing > 0.0
    whole = NODES
    if tabulated:
        for k in range(NODES):
            # The first node lies below the range, and may be that of an opposite force.
            root = low + (k - 1) * spacing
            nodes[k] = stiffness(sqrt(max(root, 0.0)), p)
            if not nodes[k] < inf:
                whole = min(whole, k - NEAR_PULL_IN)
        if low < spacing:
            nodes[0] = 3.0 * nodes[1] - 3.0 * nodes[2] + nodes[3]
    for k in range(u.size):
        place = (pull[k] - low) / spacing if tabulated else 0.0
        node = min(int(place), NODES - 4)
        if not tabulated or node + 3 >= whole:
            result[k] = stiffness(sqrt(pull[k]), p)
            continue
        w0, w1, w2, w3 = weights(place - node + 1.0)
        result[k] = w0 * nodes[node] + w1 * nodes[node + 1]
        result[k] += w2 * nodes[node + 2] + w3 * nodes[node + 3]
    return result


@njit(DERIVATIVE, cache=True, error_model="numpy")
def suspended(x: np.ndarray, k: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Force balance of the mass on a film of stiffness ``k``: m ÿ = m g - c ẏ - k y."""
    dx[0] = x[1]
    dx[1] = GRAVITY - (p[1] * x[1] + k * x[0]) / p[0]


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Force balance of the mass: m ÿ = m g - c ẏ - k(u) y."""
    suspended(x, stiffness(u, p), p, dx)


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x: np.ndarray, u: float, p: np.ndarray) -> float:
    """Displacement in mm."""
    return float(1e3 * x[0])


simulation = Simulation(
    name="dea_membrane",
    input_unit="V",
    output_unit="mm",
    states=(State("position", "m", 6e-4), State("velocity", "m/s", 0.0)),
    parameters=(
        Parameter("mass", "kg", 3.0e-3, 0.1, 1e-4, 1e-1, log=True),
        Parameter("dashpot", "N s/m", 0.8, 0.8, 1e-4, 10.0, log=True),
        Parameter("shear_c10", "Pa", 3.5e4, 0.3, 1e3, 2e5, log=True),
        Parameter("shear_c20", "Pa", -376.0, 100.0, -1500.0, 500.0),
        Parameter("shear_c30", "Pa", 3.28, 0.0),
        Parameter("prestretch", "1", 3.3, 0.1, 1.2, 5.0, log=True),
        Parameter("permittivity", "1", 3.5, 0.2, 1.0, 20.0, log=True),
        Parameter("frame_radius", "m", 0.040, 0.0),
        Parameter("electrode_radius", "m", 0.0175, 0.0),
        Parameter("contact_radius", "m", 0.002, 0.0),
        Parameter("thickness", "m", 5e-4, 0.0),
        Parameter("amplifier_gain", "V/V", 800.0, 0.0),
    ),
    derivative=derivative,
    output=output,
    drive="permittivity",
    force_ports=(
        ForcePort(equation="velocity", position="position", velocity="velocity", rest=0.0),
    ),
    output_offset_spread=0.1,
    lead_in=2.0,
    action=InputAction(stiffnesses, suspended),
)
