"""A mass on a spring and a damper, driven by a force."""

import numpy as np
from numba import njit

from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT
from dea.simulation.simulation import Simulation
from dea.simulation.state import State


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Equation of motion ÿ + 2 ζ ω ẏ + ω² y = ω² g u, with ω = 2 π f."""
    omega = 2.0 * np.pi * p[0]
    dx[0] = x[1]
    dx[1] = omega * omega * (p[2] * u - x[0]) - 2.0 * p[1] * omega * x[1]


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x: np.ndarray, u: float, p: np.ndarray) -> float:
    """Position, as the sensor gives it."""
    return float(x[0])


simulation = Simulation(
    name="mass_spring_damper",
    input_unit="V",
    output_unit="V",
    states=(State("position", "V", 0.0, 0.1), State("velocity", "V/s", 0.0, 30.0)),
    parameters=(
        Parameter("natural_frequency", "Hz", 70.0, 0.5, 1e-2, 1e4, log=True),
        Parameter("damping_ratio", "1", 0.1, 1.0, 1e-4, 20.0, log=True),
        Parameter("static_gain", "V/V", 1.0, 1.0, 1e-3, 1e3, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="static_gain",
    force_ports=(ForcePort(equation="velocity", position="position", velocity="velocity"),),
    output_offset_spread=0.05,
    accuracy=1e-3,
    input_interpolation="smooth",
)
