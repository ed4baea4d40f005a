"""A carriage on a spring, without the friction of its guide."""

from dea.simulation import ForcePort, Parameter, Simulation, State


def derivative(x, u, p, dx):
    """A carriage on a spring: position x[0] (mm) and velocity x[1] (mm/s), driven by u (V)."""
    stiffness, damping, gain = p[0], p[1], p[2]
    dx[0] = x[1]
    dx[1] = gain * u - stiffness * x[0] - damping * x[1]


def output(x, u, p):
    """Its position (mm)."""
    return x[0]


simulation = Simulation(
    name="carriage",
    input_unit="V",
    output_unit="mm",
    states=(State("position", "mm", initial=0.0), State("velocity", "mm/s", initial=0.0)),
    parameters=(
        # nominal, low and high in the unit; spread: prior standard deviation, with log=True that of
        # the natural logarithm (0.3: a factor of 1.35 either way); low and high: bounds of the fit
        Parameter("stiffness", "1/s^2", nominal=400.0, spread=0.3, low=1.0, high=1e5, log=True),
        Parameter("damping", "1/s", nominal=20.0, spread=0.5, low=0.1, high=1e4, log=True),
        Parameter("gain", "mm/s^2/V", nominal=400.0, spread=0.3, low=1.0, high=1e5, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="gain",  # the port for drifts of the gain
    force_ports=(ForcePort(equation="velocity", position="position", velocity="velocity"),),
    output_offset_spread=0.5,
    lead_in=1.0,  # s for which the first input is held, so that it has settled
)
