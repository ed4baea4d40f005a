"""Two tanks in cascade, fed by a pump, each emptying through a hole (Bernoulli's law).

Schoukens and Noël (2017), IFAC-PapersOnLine 50:446, describe the rig.
"""

from math import sqrt

from numba import njit

from dea.discrepancy.integrate import DERIVATIVE, OUTPUT
from dea.discrepancy.parameter import Parameter
from dea.discrepancy.simulation import Balance, Simulation, State


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x, u, p, dx):
    """Water balances of the upper and the lower tank; levels in units of the sensor."""
    upper, lower = sqrt(max(x[0], 0.0)), sqrt(max(x[1], 0.0))
    dx[0] = -p[0] * upper + p[3] * u
    dx[1] = p[1] * upper - p[2] * lower


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x, u, p):
    """Level of the lower tank, in volts of its sensor."""
    return x[1]


simulation = Simulation(
    name="cascaded_tanks",
    input_unit="V",
    output_unit="V",
    states=(State("upper_level", "V", 5.0, 2.0), State("lower_level", "V", 5.0, 1.0)),
    parameters=(
        Parameter("upper_outflow", "V^0.5/s", 0.05, 0.7, 1e-3, 1.0, log=True),
        Parameter("lower_inflow", "V^0.5/s", 0.05, 0.7, 1e-3, 1.0, log=True),
        Parameter("lower_outflow", "V^0.5/s", 0.05, 0.7, 1e-3, 1.0, log=True),
        Parameter("pump_gain", "1/s", 0.04, 0.7, 1e-3, 1.0, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="pump_gain",
    balances=(
        Balance(equation="upper_level", position="upper_level", velocity=None),
        Balance(equation="lower_level", position="lower_level", velocity=None),
    ),
    output_offset_spread=0.5,
)
