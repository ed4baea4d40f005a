"""The library of SINDy on the discrepancy, and the effect that each of its terms is a sign of.

A term is a function of the simulated output y, its rate v, the input u and time; all of them are
known where the output is not measured. What it is a sign of depends on what is regressed: to the
rate or acceleration of the residual a force adds as it is, and what a sensor adds to the reading
appears as its rate (a curve as y v, a lag as the acceleration); to the residual itself, a sensor
adds as it is.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.signal import lsim, periodogram

from dea.arrays import Array
from dea.discrepancy.evidence.residual_model import play, standard
from dea.simulation import low_pass

# What a term is that only corrects parameters of the simulation, and one that the catalogue lacks.
CORRECTION, FOREIGN = "correction", "foreign"
_DELAYS = (1, 3, 9)  # samples
_FAST = (3.0, 9.0, 27.0)  # samples, time constants of lags
_SLOW = (0.02, 0.08, 0.3)  # of the record, time constants of memory
_RADII = (0.2, 0.6, 1.2)  # of plays, in deviations of the output
_INSTANTS = 8
_LINES = 2
Add = Callable[..., None]


@dataclass(frozen=True)
class Term:
    """A column (n,) of the library, and what it is a sign of, in the motion and in the reading."""

    name: str
    in_motion: str
    in_reading: str
    values: Array


def library(u: Array, simulated: Array, residual: Array, interval: float) -> list[Term]:
    """Return the terms over the whole record, each with a root mean square of one.

    ``residual`` (m,) tells the frequencies of waves and resonances alone.
    """
    found: list[Term] = []

    def add(name: str, values: Array, in_motion: str, in_reading: str = "") -> None:
        size = float(np.sqrt(np.mean(values**2))) or 1.0
        found.append(Term(name, in_motion, in_reading or in_motion, values / size))

    _add_states(add, u, simulated, interval)
    bipolar = float(u.min()) < 0.0 < float(u.max())
    u, y = standard(u), standard(simulated)
    v = standard(np.gradient(simulated, interval))
    _add_limits(add, u, y, v, interval, bipolar)
    _add_memory(add, u, y)
    _add_courses(add, u, y)
    _add_lines(add, u, residual, interval)
    return found


def _add_states(add: Add, u: Array, simulated: Array, interval: float) -> None:
    rate = np.gradient(simulated, interval)
    u, y, v = standard(u), standard(simulated), standard(rate)
    a = standard(np.gradient(rate, interval))
    add("1", np.ones(u.size), CORRECTION)
    add("u", u, CORRECTION)
    add("y", y, CORRECTION)
    add("v", v, CORRECTION, "sensor_lag")
    add("a", a, "sensor_lag")
    add("y^2", y**2, "strain_stiffening", "sensor_nonlinearity")
    add("y^3", y**3, "strain_stiffening", "sensor_nonlinearity")
    add("y v", y * v, "sensor_nonlinearity", FOREIGN)
    add("y^2 v", y**2 * v, "sensor_nonlinearity", FOREIGN)
    add("sign(v)", np.tanh(v / 0.05), "coulomb_friction")
    for name, product in (
        ("u^2", u**2), ("u y", u * y), ("u v", u * v), ("v |v|", v * np.abs(v)), ("v^3", v**3),
    ):  # fmt: skip
        add(name, product, FOREIGN)


def _add_limits(add: Add, u: Array, y: Array, v: Array, interval: float, bipolar: bool) -> None:
    size, way = (np.abs(u), np.sign(u)) if bipolar else (u - u.min(), np.ones(u.size))
    low, high = np.quantile(size, [0.15, 0.85])
    add("low u", way * np.maximum(low - size, 0.0), "dead_zone")
    add("high u", way * np.maximum(size - high, 0.0), "input_saturation")
    push = np.gradient(u, interval)
    fast = np.quantile(np.abs(push), 0.7)
    add("fast u", push - np.clip(push, -fast, fast), "slew_limit")
    bottom, top = np.quantile(y, [0.1, 0.9])
    add("low y", np.maximum(bottom - y, 0.0), "end_stop", "output_saturation")
    add("high y", np.maximum(y - top, 0.0), "end_stop", "output_saturation")
    add("v at low y", np.where(y < bottom, v, 0.0), "output_saturation", FOREIGN)
    add("v at high y", np.where(y > top, v, 0.0), "output_saturation", FOREIGN)


def _add_memory(add: Add, u: Array, y: Array) -> None:
    for k in _DELAYS:
        late = np.concatenate([np.full(k, u[0]), u[:-k]])
        add(f"u delayed by {k}", late - u, "transport_delay")
    for samples in _FAST:
        add(f"u lagged by {samples:g}", low_pass(u, [samples, 1.0]) - u, "electrode_lag")
    for part in _SLOW:
        slow = [part * u.size, 1.0]
        add(f"memory of u, {part:g}", low_pass(u, slow), "charge_leakage")
        add(f"memory of y, {part:g}", low_pass(y, slow), "viscoelastic_creep")
    for radius in _RADII:
        # A play is the same beside y.
        stop = y - play(y, radius)
        add(f"stop(y, {radius:g})", stop, "rate_independent_hysteresis", "backlash")


def _add_courses(add: Add, u: Array, y: Array) -> None:
    x = np.linspace(0.0, 1.0, u.size)
    add("time", x, "baseline_drift")
    add("time^2", x**2, "baseline_drift")
    add("time u", x * u, "gain_drift")
    add("time^2 u", x**2 * u, "gain_drift")
    add("travel y", np.cumsum(np.abs(np.gradient(y))) * y, "cyclic_softening")
    add("log(1 + time) y", np.log1p(x / 0.02) * y, "stress_relaxation")
    for instant in np.linspace(0.0, 1.0, _INSTANTS + 2)[1:-1]:
        add(f"u after {instant:.2g}", np.where(x > instant, u, 0.0), "step_fault")


def _add_lines(add: Add, u: Array, residual: Array, interval: float) -> None:
    """Add waves, and resonances that the input excites, at the residual's strongest lines."""
    frequency, power = periodogram(residual, 1.0 / interval, "hann", detrend="linear")
    power[:4] = 0.0  # trends
    t = np.arange(u.size) * interval
    for _ in range(_LINES):
        peak = int(np.argmax(power))
        omega = 2.0 * np.pi * frequency[peak]
        power[max(0, peak - 6) : peak + 7] = 0.0
        add(f"cos({omega:.4g} t)", np.cos(omega * t), "periodic_disturbance")
        add(f"sin({omega:.4g} t)", np.sin(omega * t), "periodic_disturbance")
        if 0.0 < omega * interval < 0.5 * np.pi:
            mode = ([omega**2], [1.0, 0.1 * omega, omega**2])
            add(f"ring(u, {omega:.4g})", lsim(mode, u, t)[1], "second_mode")
