"""A wheel of which a speed alone is known: nothing holds it at a place."""

from dataclasses import replace

from dea.simulation import ForcePort, Parameter, Simulation, State


def wheel(**changed):
    """A wheel with drag that 1 V drives at 2 m/s, with other attributes where given."""

    def derivative(x, u, p, dx):
        dx[0] = (p[0] * u - x[0]) / 0.2

    simulation = Simulation(
        name="wheel", input_unit="V", output_unit="m/s", states=(State("speed", "m/s", 0.0),),
        parameters=(Parameter("gain", "m/s/V", 2.0, 0.2),), derivative=derivative,
        output=lambda x, u, p: x[0], drive="gain", input_interpolation="zero",
        force_ports=(ForcePort("speed", None, "speed"),),
    )  # fmt: skip
    return replace(simulation, **changed)
