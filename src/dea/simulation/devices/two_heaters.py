"""Two heated transistors side by side on a board, each with a sensor (temperature control lab).

Park, Martin, Kelly and Hedengren (2020), Computers & Chemical Engineering 135:106736, describe the
board and its heat balance. Each transistor is one lump that loses heat to the room by convection
and radiation and exchanges it with the other; its sensor follows with a lag. Sizes, and the nominal
values and bounds of what is estimated, are those of the course that the board was made for
(apmonitor.com/pdc, energy balance of both heaters and its estimation).
"""

import numpy as np
from numba import njit

from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE_OF_SEVERAL, OUTPUT_OF_SEVERAL
from dea.simulation.simulation import Simulation
from dea.simulation.state import State

_CAPACITY = 4e-3 * 500.0  # J/K, 4 g of 500 J/(kg K)
_AREA, _BETWEEN = 1e-3, 2e-4  # m^2, of one transistor to the room, and to the other
_RADIATION = 0.9 * 5.67e-8  # W/(m^2 K^4), emissivity times Stefan and Boltzmann's constant
_KELVIN = 273.15


@njit("float64(float64, float64, float64, float64)", cache=True, error_model="numpy")
def _received(warmer: float, own: float, transfer: float, area: float) -> float:
    """Return the heat (W) that one surface receives from another, both in degC."""
    radiated = (warmer + _KELVIN) ** 4 - (own + _KELVIN) ** 4
    return area * (transfer * (warmer - own) + _RADIATION * radiated)


@njit(DERIVATIVE_OF_SEVERAL, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: np.ndarray, p: np.ndarray, dx: np.ndarray) -> None:
    """Heat balances of both transistors, and the lag of the first one's sensor."""
    exchanged = _received(x[1], x[0], p[1], _BETWEEN)
    dx[0] = (_received(p[5], x[0], p[0], _AREA) + exchanged + p[2] * u[0]) / _CAPACITY
    dx[1] = (_received(p[5], x[1], p[0], _AREA) - exchanged + p[3] * u[1]) / _CAPACITY
    dx[2] = (x[0] - x[2]) / p[4]


@njit(OUTPUT_OF_SEVERAL, cache=True, error_model="numpy")
def output(x: np.ndarray, u: np.ndarray, p: np.ndarray) -> float:
    """Temperature of the sensor."""
    return float(x[2])


simulation = Simulation(
    name="two_heaters",
    input_name=("heater 1", "heater 2"),
    input_unit=("%", "%"),
    output_unit="degC",
    states=(
        State("heater_1", "degC", 23.0, 5.0),
        State("heater_2", "degC", 23.0, 5.0),
        State("sensor", "degC", 23.0, 5.0),
    ),
    parameters=(
        Parameter("heat_transfer", "W/m^2/K", 10.0, 0.4, 2.0, 20.0, log=True),
        Parameter("exchange", "W/m^2/K", 20.0, 0.4, 5.0, 40.0, log=True),
        Parameter("heating_1", "W/%", 0.01, 0.35, 5e-3, 0.02, log=True),
        Parameter("heating_2", "W/%", 0.0075, 0.35, 2e-3, 0.015, log=True),
        Parameter("sensor_time", "s", 10.0, 0.6, 5.0, 60.0, log=True),
        Parameter("room", "degC", 23.0, 2.0, 10.0, 35.0),
    ),
    derivative=derivative,
    output=output,
    drive=("heating_1", "heating_2"),
    # Heat can be stored beside either transistor, or lost by another law.
    force_ports=(
        ForcePort(equation="heater_1", position="heater_1", velocity=None, rest=23.0),
        ForcePort(equation="heater_2", position="heater_2", velocity=None, rest=23.0),
    ),
    # The sensor's data sheet (TMP36) says 1 K at room temperature.
    output_offset_spread=1.0,
)
