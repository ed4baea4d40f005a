"""A dielectric elastomer membrane, electroded at its centre, that carries a mass: elastic film.

The prestretched film is clamped at the frame and electroded out to a radius a; under voltage the
electroded disc grows by an in-plane stretch x at the cost of the passive annulus around it. The
annulus deforms as a linear elastic one, u = α (R − b²/R) with u(a) = (x − 1) a; x makes the virtual
work of the true stresses and of the Maxwell stress vanish. The mass hangs on the tensions that
result: a cone of slope F/(2π r N). An incompressible Yeoh film, an ideal amplifier and sensor, one
dashpot. Wissler and Mazza (2007), Sensors and Actuators A 134:494, for the film; Suo (2010), Acta
Mechanica Solida Sinica 23:549, for the field.
"""

from math import log, nan, pi

import numpy as np
from numba import njit

from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT
from dea.simulation.simulation import Simulation
from dea.simulation.state import State

VACUUM_PERMITTIVITY = 8.8541878128e-12
GRAVITY = 9.80665
# Radii across the annulus, where the stresses are summed by Boole's rule in ln R.
INTERVALS = 4
BOOLE = (14.0 / 45.0, 64.0 / 45.0, 24.0 / 45.0, 64.0 / 45.0, 14.0 / 45.0)
TRIES = 40
CLOSE = 1e-7


@njit(cache=True, error_model="numpy")
def work(x: float, u: float, p: np.ndarray) -> tuple[float, float]:
    """Return the virtual work that resists dx, in N m, and ∫ dr/(r N) in m/N; NaN if slack.

    The work is over 2π. A film of true stress σ and stretches λ does the virtual work
    σ₁ δλ₁/λ₁ + σ₂ δλ₂/λ₂ per volume; its tension is σ₁ times its thickness.
    """
    c10, c20, c30, prestretch, epsilon_r = p[2], p[3], p[4], p[5], p[6]
    frame_radius, electrode_radius, contact_radius = p[7], p[8], p[9]
    thickness, gain = p[10] / (prestretch * prestretch), p[11]
    squared = (frame_radius / electrode_radius) ** 2
    give = 1.0 / (squared - 1.0)
    square = prestretch * prestretch * x * x
    contraction = 1.0 / (square * square)
    invariant = 2.0 * square + contraction - 3.0
    W = c10 + invariant * (2.0 * c20 + 3.0 * c30 * invariant)
    field = gain * u * x * x / thickness
    sigma = 2.0 * W * (square - contraction)
    sigma -= VACUUM_PERMITTIVITY * epsilon_r * field * field
    if not sigma > 0.0:
        return nan, nan
    resisting = sigma / x
    compliance = log(electrode_radius * x / contact_radius) * x * x / sigma
    ratio = squared ** (1.0 / INTERVALS)
    step = 0.5 * log(ratio)
    for k in range(INTERVALS + 1):
        radial, hoop = (
            1.0 - give * (squared + 1.0) * (x - 1.0),
            1.0 + give * (squared - 1.0) * (x - 1.0),
        )
        square_1, square_2 = (prestretch * radial) ** 2, (prestretch * hoop) ** 2
        contraction = 1.0 / (square_1 * square_2)
        invariant = square_1 + square_2 + contraction - 3.0
        W = c10 + invariant * (2.0 * c20 + 3.0 * c30 * invariant)
        sigma_1, sigma_2 = 2.0 * W * (square_1 - contraction), 2.0 * W * (square_2 - contraction)
        # (R/a)² is b²/a² over the square of b/R.
        annulus = BOOLE[k] * step * (1.0 + 1.0 / give) / squared
        strained = (squared - 1.0) * sigma_2 / hoop - (squared + 1.0) * sigma_1 / radial
        resisting += annulus * give * strained
        compliance += BOOLE[k] * step * radial * radial / sigma_1
        squared /= ratio
    return electrode_radius * electrode_radius * thickness * resisting, compliance / thickness


@njit(cache=True, error_model="numpy")
def stiffness(u: float, p: np.ndarray) -> float:
    """Return the vertical stiffness in N/m, NaN beyond pull-in.

    x is found by inverse quadratic interpolation from three estimates below it: the work as a
    function of x is concave, so that secants stay on this side of pull-in.
    """
    x_0, x_1 = 1.0, 1.005
    work_0, _ = work(x_0, u, p)
    work_1, compliance = work(x_1, u, p)
    x_2 = x_1 - work_1 * (x_1 - x_0) / (work_1 - work_0)
    for _ in range(TRIES):
        work_2, compliance = work(x_2, u, p)
        d_01, d_02, d_12 = work_0 - work_1, work_0 - work_2, work_1 - work_2
        x_3 = x_0 * work_1 * work_2 / (d_01 * d_02)
        x_3 -= x_1 * work_0 * work_2 / (d_01 * d_12)
        x_3 += x_2 * work_0 * work_1 / (d_02 * d_12)
        if abs(x_3 - x_2) < CLOSE:
            return 2.0 * pi / compliance
        x_0, x_1, x_2 = x_1, x_2, x_3
        work_0, work_1 = work_1, work_2
    return nan


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Force balance of the mass: m ÿ = m g - c ẏ - k(u) y."""
    mass, c = p[0], p[1]
    dx[0] = x[1]
    dx[1] = GRAVITY - (c * x[1] + stiffness(u, p) * x[0]) / mass


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
)
