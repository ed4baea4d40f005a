"""A carriage on a spring with known priors: a simulation as a user writes one."""

from dataclasses import replace

from dea.simulation import Parameter, State, load_simulation

CARRIAGE = simulation = replace(
    load_simulation("mass_spring_damper"),
    states=(State("position", "V", 0.0, 0.2), State("velocity", "V/s", 0.0, 2.0)),
    parameters=(
        Parameter("natural_frequency", "Hz", 1.5, 0.3, 1e-2, 1e2, log=True),
        Parameter("damping_ratio", "1", 0.5, 0.5, 1e-3, 10.0, log=True),
        Parameter("static_gain", "V/V", 1.0, 0.3, 1e-2, 1e2, log=True),
    ),
    accuracy=0.0,
    input_interpolation="zero",
)
