"""A simulation in a file of a user's, right or wrong in its equation or its ports."""

SLOPE = "p[0] * (p[1] * u - x[0])"
PORTS = 'drive="gain", force_ports=(ForcePort("level", "level", None),),'
_FILE = """
from dea.simulation import ForcePort, Parameter, Simulation, State


def derivative(x, u, p, dx):
    dx[0] = {slope}


def output(x, u, p):
    return x[0]


simulation = Simulation(
    name="mine", input_unit="V", output_unit="mm", states=(State("level", "mm", 0.0),),
    parameters=(Parameter("rate", "1/s", 2.0, 0.5, log=True), Parameter("gain", "mm/V", 1.0, 0.5)),
    derivative=derivative, output=output, {ports}
)
"""


def write_simulation(path, slope=SLOPE, ports=PORTS):
    """Write the file with an expression for the level's slope, and the ports; return its path."""
    path.write_text(_FILE.format(slope=slope, ports=ports))
    return path
