"""Two electric motors that drive a pulley through an elastic belt; the pulley's speed is measured.

Wigren and Schoukens (2017), technical report 2017-024, Uppsala University, describe the rig. The
motors, with their windings and inertia, and the belt make a linear system with one resonance.
"""

import numpy as np
from numba import njit

from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT
from dea.simulation.simulation import Simulation
from dea.simulation.state import State


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Current x₀ follows the voltage, the motors' speed x₁ the current, the pulley x₂ the belt."""
    winding, motor, omega = p[0], p[1], 2.0 * np.pi * p[2]
    dx[0] = (u - x[0]) / winding
    dx[1] = (p[4] * x[0] - x[1]) / motor
    dx[2] = x[3]
    dx[3] = omega * omega * (x[1] - x[2]) - 2.0 * p[3] * omega * x[3]


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x: np.ndarray, u: float, p: np.ndarray) -> float:
    """Speed of the pulley."""
    return float(x[2])


simulation = Simulation(
    name="electric_drive",
    input_unit="V",
    output_unit="ticks/s",
    states=(
        # In units of the voltage that would hold it.
        State("motor_current", "V", 0.0, 1.0),
        State("motor_speed", "ticks/s", 0.0, 1.0),
        State("pulley_speed", "ticks/s", 0.0, 1.0),
        State("pulley_acceleration", "ticks/s^2", 0.0, 10.0),
    ),
    parameters=(
        Parameter("winding_time", "s", 0.02, 0.7, 1e-3, 1.0, log=True),
        Parameter("motor_time", "s", 0.2, 0.7, 1e-2, 10.0, log=True),
        Parameter("belt_frequency", "Hz", 3.0, 0.5, 0.1, 20.0, log=True),
        Parameter("belt_damping", "1", 0.2, 0.7, 1e-2, 5.0, log=True),
        Parameter("speed_gain", "ticks/s/V", 2.0, 0.7, 1e-2, 1e2, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="speed_gain",
    force_ports=(ForcePort(equation="motor_speed", position=None, velocity="motor_speed"),),
    output_offset_spread=0.5,
    # A belt without slip, motors without dry friction: some percent of the speed's range.
    accuracy=0.15,
)
