"""A made device with two inputs: a body warmed from both sides, and the reading that follows it."""

from dataclasses import replace

import numpy as np

from dea.simulation import ForcePort, Parameter, Simulation, State

NAMES = ("left", "right")
INTERVAL = 0.5


def derivative(x, u, p, dx):
    """A wall x[0] that loses heat by a law with a square, and a body x[1] behind it."""
    dx[0] = -p[0] * x[0] - p[1] * x[0] * abs(x[0]) + p[2] * u[0] + p[3] * u[1] * u[1]
    dx[1] = p[4] * (x[0] - x[1]) + 0.1 * p[2] * u[0]


def linear(x, u, p, dx):
    dx[0] = -p[0] * x[0] + p[2] * u[0] + p[3] * u[1]
    dx[1] = p[4] * (x[0] - x[1]) + 0.1 * p[2] * u[0]


def output(x, u, p):
    return x[1] + 0.05 * u[1]


simulation = Simulation(
    name="warmed_wall",
    input_name=NAMES,
    input_unit=("V", "A"),
    output_unit="K",
    states=(State("wall", "K", 0.3, 0.2), State("body", "K", 0.1, 0.2)),
    parameters=(
        Parameter("loss", "1/s", 0.25, 0.3, 1e-3, 10.0, log=True),
        Parameter("square_loss", "1/s/K", 0.05, 0.3, 1e-4, 10.0, log=True),
        Parameter("gain_left", "K/s/V", 0.5, 0.3, 1e-3, 10.0, log=True),
        Parameter("gain_right", "K/s/A^2", 0.4, 0.3, 1e-3, 10.0, log=True),
        Parameter("exchange", "1/s", 0.8, 0.3, 1e-3, 10.0, log=True),
    ),
    derivative=derivative,
    output=output,
    drive=("gain_left", "gain_right"),
    force_ports=(ForcePort(equation="wall", position="wall", velocity=None),),
    input_offset_spread=(0.1, 0.0),
    output_offset_spread=0.05,
)
linear_simulation = replace(simulation, derivative=linear)


def excitation(samples, seed=0):
    """Two inputs of steps, each with its own rhythm, shape (samples, 2)."""
    rng = np.random.default_rng(seed)
    k = np.arange(samples)
    levels = rng.uniform(0.0, 2.0, (samples, 2))
    return np.column_stack([levels[k // 9, 0], levels[k // 7, 1]])
