"""A resistor heats a plate, the plate the air, and the air loses heat to the room.

Temperatures of plate x[0] and air x[1] above the room's (K), driven by u (V).
"""

from dea.simulation import ForcePort, Parameter, Simulation, State


def derivative(x, u, p, dx):
    """Write the rates of the states to dx."""
    heating, exchange, uptake, loss = p[0], p[1], p[2], p[3]
    dx[0] = heating * u * u - exchange * (x[0] - x[1])
    dx[1] = uptake * (x[0] - x[1]) - loss * x[1]


def output(x, u, p):
    """Return the reading."""
    return 20.0 + x[1]


simulation = Simulation(
    name="heated_chamber",
    input_unit="V",
    output_unit="degC",
    states=(State("plate", "K", 0.0, 1.0), State("air", "K", 0.0, 1.0)),
    parameters=(
        Parameter("heating", "K/s/V^2", 0.11, 0.3, 1e-3, 10.0, log=True),
        Parameter("exchange", "1/s", 0.12, 0.3, 1e-3, 10.0, log=True),
        Parameter("uptake", "1/s", 0.05, 0.3, 1e-4, 10.0, log=True),
        Parameter("loss", "1/s", 0.025, 0.3, 1e-4, 10.0, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="heating",
    # Heat can be stored beside the plate, or beside the air.
    force_ports=(
        ForcePort(equation="plate", position="plate", velocity=None),
        ForcePort(equation="air", position="air", velocity=None),
    ),
    output_offset_spread=1.0,
)
