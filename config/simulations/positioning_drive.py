"""A motor that turns a load against a return spring, as its data sheet describes it.

Angle x[0] (deg) and speed x[1] (deg/s), driven by u (V).
"""

from dea.simulation import ForcePort, Parameter, Simulation, State


def derivative(x, u, p, dx):
    """Write the rates of the states to dx."""
    gain, damping, stiffness = p[0], p[1], p[2]
    dx[0] = x[1]
    dx[1] = gain * u - damping * x[1] - stiffness * x[0]


def output(x, u, p):
    """Return the reading."""
    return x[0]


simulation = Simulation(
    name="positioning_drive",
    input_unit="V",
    output_unit="deg",
    states=(State("angle", "deg", 0.0, 1.0), State("speed", "deg/s", 0.0, 10.0)),
    parameters=(
        Parameter("gain", "deg/s^2/V", 6000.0, 0.3, 100.0, 1e5, log=True),
        Parameter("damping", "1/s", 18.0, 0.5, 1.0, 500.0, log=True),
        Parameter("stiffness", "1/s^2", 600.0, 0.3, 10.0, 1e5, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="gain",
    force_ports=(ForcePort(equation="speed", position="angle", velocity="speed"),),
    output_offset_spread=1.0,
)
