"""A cone-shaped dielectric elastomer membrane that carries a mass: elastic film, one dashpot.

Radial stretch λ₁ = λp √(1 + y²/L²) and hoop stretch λ₂ = λp of an incompressible Yeoh film under
the Maxwell stress of an ideal amplifier; ideal sensor. Wissler and Mazza (2007), Sensors and
Actuators A 134:494, for the film; Suo (2010), Acta Mechanica Solida Sinica 23:549, for the field.
"""

from math import pi

import numpy as np
from numba import njit

from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT
from dea.simulation.simulation import Simulation
from dea.simulation.state import State

VACUUM_PERMITTIVITY = 8.8541878128e-12
GRAVITY = 9.81


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Force balance of the mass: m ÿ = m g - c ẏ - Ω σ₁ y / (L² + y²)."""
    y, velocity = x[0], x[1]
    mass, c, c10, c20, c30, prestretch, epsilon_r = p[0], p[1], p[2], p[3], p[4], p[5], p[6]
    frame_radius, contact_radius, thickness, gain = p[7], p[8], p[9], p[10]
    L2 = (frame_radius - contact_radius) ** 2
    square_2 = prestretch * prestretch
    square_1 = square_2 * (1.0 + y * y / L2)
    contraction = 1.0 / (square_1 * square_2)
    invariant = square_1 + square_2 + contraction - 3.0
    W = c10 + 2.0 * c20 * invariant + 3.0 * c30 * invariant * invariant
    field_squared = (gain * u / thickness) ** 2 * square_1 * square_2
    sigma = 2.0 * W * (square_1 - contraction) - VACUUM_PERMITTIVITY * epsilon_r * field_squared
    volume = pi * (frame_radius**2 - contact_radius**2) * thickness / square_2
    dx[0] = velocity
    dx[1] = GRAVITY - (c * velocity + volume * sigma * y / (L2 + y * y)) / mass


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
        Parameter("shear_c10", "Pa", 1.0e4, 0.3, 1e3, 1e5, log=True),
        Parameter("shear_c20", "Pa", -94.0, 30.0, -500.0, 500.0),
        Parameter("shear_c30", "Pa", 0.82, 0.0),
        Parameter("prestretch", "1", 2.5, 0.1, 1.2, 5.0, log=True),
        Parameter("permittivity", "1", 4.7, 0.2, 1.0, 20.0, log=True),
        Parameter("frame_radius", "m", 0.020, 0.0),
        Parameter("contact_radius", "m", 0.005, 0.0),
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
