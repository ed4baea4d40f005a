"""A mass on a spring with a known force added, and tasks that are made of its records."""

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.naming.task import Posed
from dea.discrepancy import Settings
from dea.simulation import ForcePort, Parameter, Simulation, State
from dea.store import Record

RATE = 50.0
STIFFNESS, DAMPING, GAIN = 400.0, 24.0, 400.0


def derivative(x, u, p, dx):
    dx[0] = x[1]
    dx[1] = p[2] * u - p[0] * x[0] - p[1] * x[1]


def output(x, u, p):
    return x[0]


SIMULATION = Simulation(
    name="carriage",
    input_unit="V",
    output_unit="mm",
    states=(State("position", "mm", 0.0), State("velocity", "mm/s", 0.0)),
    parameters=(
        Parameter("stiffness", "1/s^2", STIFFNESS, 0.1, 1.0, 1e5, log=True),
        Parameter("damping", "1/s", DAMPING, 0.1, 1.0, 1e4, log=True),
        Parameter("gain", "mm/s^2/V", GAIN, 0.1, 1.0, 1e5, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="gain",
    force_ports=(ForcePort(equation="velocity", position="position", velocity="velocity"),),
    lead_in=1.0,
)


def excitation(samples, seed=1):
    """Noise below 2 Hz of about unit deviation."""
    rng = np.random.default_rng(seed)
    spectrum = np.fft.rfft(rng.standard_normal(samples))
    spectrum[np.fft.rfftfreq(samples, 1.0 / RATE) > 2.0] = 0.0
    u = np.fft.irfft(spectrum, samples)
    return u / u.std()


def posed(force=lambda x, v: 0.0, samples=2000, noise=2e-3, seed=1, kept_back=0.2):
    """Return the task of a record of the mass with ``force(x, v)`` (mm/s^2) added."""
    return pose(recorded(force, samples, noise, seed), kept_back)


def pose(record, kept_back=0.2, effects=()):
    """Return the task of a record, in which a diagnosis is offered all effects or these."""
    settings = Settings(warm_up=0.5, effects=effects)
    return Posed.of("made", record, kept_back, SIMULATION, settings)


def recorded(force=lambda x, v: 0.0, samples=2000, noise=2e-3, seed=1):
    """Return a record of the mass with ``force(x, v)`` (mm/s^2) added."""
    u = excitation(samples, seed)

    def slopes(t, x):
        level = u[min(int(t * RATE), samples - 1)]
        return [x[1], GAIN * level - STIFFNESS * x[0] - DAMPING * x[1] + force(x[0], x[1])]

    start = [u[0] * GAIN / STIFFNESS, 0.0]
    times = np.arange(samples) / RATE
    x = solve_ivp(
        slopes, (0.0, times[-1]), start, method="LSODA", t_eval=times,
        max_step=0.5 / RATE, rtol=1e-8, atol=1e-10,
    ).y[0]  # fmt: skip
    y = x + noise * np.random.default_rng(seed + 100).standard_normal(samples)
    return Record.of(u, y, RATE, units=("V", "mm"))
