"""Two tanks in cascade, fed by a pump, each emptying through a hole (Torricelli's law).

Schoukens and Noël (2017), IFAC-PapersOnLine 50:446, describe the rig. The upper tank's level is
not measured, so that its unit is free; it is chosen such that water keeps its amount on its way
from one tank to the other.
"""

from math import sqrt

import numpy as np
from numba import njit

from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT
from dea.simulation.simulation import Simulation
from dea.simulation.state import State


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Water balances of the upper and the lower tank; levels in units of the sensor."""
    upper, lower = sqrt(max(x[0], 0.0)), sqrt(max(x[1], 0.0))
    dx[0] = -p[0] * upper + p[3] * u
    dx[1] = p[1] * upper - p[2] * lower


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x: np.ndarray, u: float, p: np.ndarray) -> float:
    """Level of the lower tank, in volts of its sensor."""
    return float(x[1])


simulation = Simulation(
    name="cascaded_tanks",
    input_unit="V",
    output_unit="V",
    states=(State("upper_level", "V", 5.0, 2.0), State("lower_level", "V", 5.0, 2.0)),
    parameters=(
        Parameter("upper_outflow", "V^0.5/s", 0.05, 0.7, 1e-3, 1.0, log=True),
        Parameter("lower_inflow", "V^0.5/s", 0.05, 0.7, 1e-3, 1.0, log=True),
        Parameter("lower_outflow", "V^0.5/s", 0.05, 0.7, 1e-3, 1.0, log=True),
        Parameter("pump_gain", "1/s", 0.04, 0.7, 1e-3, 1.0, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="pump_gain",
    # Water can be lost from either tank, or pass from the upper to the lower one.
    force_ports=(
        ForcePort(equation="upper_level", position="upper_level", velocity=None),
        ForcePort(
            equation="upper_level", position="upper_level", velocity=None, reaction="lower_level"
        ),
        ForcePort(equation="lower_level", position="lower_level", velocity=None),
    ),
    # A pump delivers only from some voltage on.
    input_offset_spread=1.0,
    # The hole lies somewhere below the level that the sensor calls zero.
    output_offset_spread=1.5,
    # No friction in holes and pipes, a pump that follows at once: some percent of the range.
    accuracy=0.25,
)
