"""Laws that act later: slew limits, delays and lags of the input and of the sensor."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.plant.array import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import cascade, delay, parallel
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _differential_pair(c: Array, m: Array, u: Array) -> None:
    """Follow at a rate that saturates as a tanh; rising and falling have limits of their own."""
    rise, fall, quick = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        limit = rise if error > 0.0 else fall
        m[1] += SUBSTEP * limit * np.tanh(error / (limit * quick))
        u[k] = m[1]


def _rate(size: float, conditions: Conditions) -> float:
    """Return the rate, V/s, that takes ``size`` periods of the band for the whole range."""
    return conditions.span / (size * conditions.time)


@tuning("Solomon, IEEE J. Solid-State Circuits 9 (1974) 314: slewing of a differential pair")
def differential_pair(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A rate that is a tanh of the error, with different limits up and down."""
    rate = _rate(size, conditions)
    asymmetry = rng.uniform(0.85, 1.2)
    constants = [rate * asymmetry, rate / asymmetry, 4.0 * SUBSTEP]
    return Built(SignalLaw(_differential_pair, constants, [0.0, 0.0]), {"rate": rate})


@njit(cache=True)
def _limited_acceleration(c: Array, m: Array, u: Array) -> None:
    """Follow with bounded speed and acceleration: m holds whether started, place and speed."""
    rate, acceleration = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    most = acceleration * SUBSTEP
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        # The speed from which the place stops just at the target, in whole sub-steps.
        wanted = np.sqrt(0.25 * most * most + 2.0 * acceleration * abs(error)) - 0.5 * most
        wanted = min(wanted, rate, abs(error) / SUBSTEP) * np.sign(error)
        m[2] += min(max(wanted - m[2], -most), most)
        m[1] += SUBSTEP * m[2]
        u[k] = m[1]


@tuning("Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines (2008): trapezoid")
def trapezoidal_speed(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A bounded rate that is itself reached at a bounded acceleration."""
    rate = _rate(size, conditions)
    rise = rng.uniform(0.02, 0.08) * size * conditions.time + 4.0 * SUBSTEP
    law = SignalLaw(_limited_acceleration, [rate, rate / rise], np.zeros(3))
    return Built(law, {"rate": rate})


@njit(cache=True)
def _orifice(c: Array, m: Array, u: Array) -> None:
    """A rate that is a root of the error up to c[1], and constant beyond."""
    rate, opening = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        share = np.sqrt(min(abs(error) / opening, 1.0))
        step = min(SUBSTEP * rate * share, abs(error))
        m[1] += step * np.sign(error)
        u[k] = m[1]


@reporting("Merritt, Hydraulic Control Systems (1967): flow through an orifice, valve fully open")
def orifice_flow(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A rate that falls with the root of the error near the target."""
    rate = _rate(size, conditions)
    opening = rng.uniform(0.01, 0.06) * conditions.span
    return Built(SignalLaw(_orifice, [rate, opening], [0.0, 0.0]), {"rate": rate})


@njit(cache=True)
def _foldback(c: Array, m: Array, u: Array) -> None:
    """A rate that falls (rising) or grows (falling) in a straight line with the output's level."""
    rate, tilt, middle, half = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        level = min(max((m[1] - middle) / half, -1.0), 1.0)
        limit = SUBSTEP * rate * (1.0 - tilt * level * np.sign(error))
        m[1] += min(max(error, -limit), limit)
        u[k] = m[1]


@reporting("Horowitz and Hill, The Art of Electronics (2015): charging by a current with foldback")
def foldback_current(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The nearer the output to the end it moves to, the slower the rate."""
    rate = _rate(size, conditions)
    middle, half = 0.5 * (conditions.low + conditions.high), 0.5 * conditions.span
    constants = [rate, rng.uniform(0.15, 0.4), middle, half]
    return Built(SignalLaw(_foldback, constants, [0.0, 0.0]), {"rate": rate})


@tuning("a pure delay: Smith, Chem. Eng. Prog. 53 (1957) 217")
def pure_delay(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A delay of ``size`` periods of the band, to a millisecond."""
    seconds = size * conditions.time
    return Built(delay(seconds), {"delay": max(round(seconds / SUBSTEP), 1) * SUBSTEP})


@njit(cache=True)
def _jittered(c: Array, m: Array, u: Array) -> None:
    """c: mean, depth (s), (frequency, phase) of every sine of the delay.

    m: count, delay in sub-steps, which is updated every tenth one, and a ring of past values.
    """
    length, sines = m.shape[0] - 2, (c.shape[0] - 2) // 2
    if m[0] == 0.0:
        m[2:] = u[0]
    for k in range(u.shape[0]):
        place = int(m[0])
        m[2 + place % length] = u[k]
        if place % 10 == 0:
            wander = 0.0
            for i in range(sines):
                wander += np.sin(2.0 * np.pi * c[2 + 2 * i] * m[0] * SUBSTEP + c[3 + 2 * i])
            m[1] = (c[0] + c[1] * wander / sines) / SUBSTEP
        late = m[1]
        whole = int(late)
        near, far = m[2 + (place - whole) % length], m[2 + (place - whole - 1) % length]
        u[k] = near + (late - whole) * (far - near)
        m[0] += 1.0


@reporting("Nilsson, Real-Time Control Systems with Delays (1998): a network's varying delay")
def jittered_delay(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A delay that wanders by up to a fifth around its mean, faster than the band and slower."""
    mean = size * conditions.time
    depth = rng.uniform(0.05, 0.2) * mean
    frequencies = np.exp(rng.uniform(np.log(0.05), np.log(3.0), 6)) / conditions.time
    sines = np.column_stack([frequencies, rng.uniform(0.0, 2.0 * np.pi, 6)]).ravel()
    ring = np.zeros(3 + int(np.ceil((mean + depth) / SUBSTEP)))
    law = SignalLaw(_jittered, np.concatenate([[mean, depth], sines]), np.append([0.0, 0.0], ring))
    return Built(law, {"delay": mean})


@reporting("Levenspiel, Chemical Reaction Engineering (1999): plug flow as many tanks in series")
def dispersed_plug_flow(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Twenty-five to sixty equal lags in series: a delay whose edge is slightly blurred."""
    tanks = int(rng.integers(25, 61))
    mean = size * conditions.time
    return Built(cascade(np.full(tanks, mean / tanks)), {"delay": mean})


@njit(cache=True)
def _ladder(c: Array, m: Array, u: Array) -> None:
    """A distributed resistance and capacitance: diffusion of the voltage along a ladder.

    c holds the share of the difference between neighbours that passes in one internal step, and the
    number of internal steps per sub-step; the film's voltage is the mean over the ladder.
    """
    share, steps = c[0], int(c[1])
    rungs = m.shape[0] - 1
    if m[0] == 0.0:
        m[0] = 1.0
        m[1:] = u[0]
    for k in range(u.shape[0]):
        for _ in range(steps):
            before = u[k]
            for i in range(1, rungs + 1):
                here = m[i]
                after = m[i + 1] if i < rungs else here
                m[i] = here + share * (before - 2.0 * here + after)
                before = here
        u[k] = np.mean(m[1:])


@tuning("Thomson, Proc. R. Soc. 7 (1855) 382: diffusion along a cable, as a ladder")
def cable_diffusion(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A ladder of six rungs whose mean delay is that of a single lag of ``size`` band periods."""
    rungs, mean = 6, size * conditions.time
    # The mean over n rungs of the ladder's delays is (n + 1)(2n + 1)/6 rung times.
    rung = mean / ((rungs + 1) * (2 * rungs + 1) / 6.0)
    rate = SUBSTEP / rung
    steps = max(int(np.ceil(rate / 0.25)), 1)
    return Built(SignalLaw(_ladder, [rate / steps, steps], np.zeros(1 + rungs)), {"lag": mean})


@tuning("Harriott, Process Control (1964): two unequal stages of resistance and capacity")
def two_stages(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Two lags in series of together ``size`` band periods."""
    mean, share = size * conditions.time, rng.uniform(0.55, 0.8)
    return Built(cascade(mean * np.array([share, 1.0 - share])), {"lag": mean})


@reporting("Cole and Cole, J. Chem. Phys. 9 (1941) 341: a distribution of relaxation times")
def cole_cole(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Lags side by side, with Cole and Cole's density around a central time."""
    alpha, middle = rng.uniform(0.15, 0.35), size * conditions.time
    ratios = np.linspace(-4.0, 4.0, 17)
    density = np.sin(alpha * np.pi) / (np.cosh((1.0 - alpha) * ratios) - np.cos(alpha * np.pi))
    weights = density / density.sum()
    return Built(parallel(0.0, weights, middle * np.exp(ratios)), {})


@njit(cache=True)
def _loaded_lag(c: Array, m: Array, u: Array) -> None:
    """A first-order lag whose time constant grows with the level it has reached."""
    time, growth, low, span = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        level = min(max((m[1] - low) / span, 0.0), 1.0)
        m[1] += (u[k] - m[1]) * -np.expm1(-SUBSTEP / (time * (1.0 + growth * level)))
        u[k] = m[1]


@reporting("Rosset and Shea, Appl. Phys. A 110 (2013) 281: electrodes whose resistance grows")
def stretched_electrode(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lag that is slower at high commands, where the electrode is stretched."""
    growth, mean = rng.uniform(0.5, 2.0), size * conditions.time
    constants = [mean / (1.0 + 0.5 * growth), growth, conditions.low, conditions.span]
    return Built(SignalLaw(_loaded_lag, constants, [0.0, 0.0]), {"lag": mean})


@njit(cache=True)
def _averaged(c: Array, m: Array, y: Array) -> None:
    """A moving mean; m holds place, whether filled, the sum and a ring."""
    length = m.shape[0] - 3
    if m[1] == 0.0:
        m[1], m[2] = 1.0, length * y[0]
        m[3:] = y[0]
    place = int(m[0])
    for k in range(y.shape[0]):
        m[2] += y[k] - m[3 + place]
        m[3 + place] = y[k]
        place = (place + 1) % length
        y[k] = m[2] / length
    m[0] = place


@tuning("Oppenheim and Schafer, Discrete-Time Signal Processing (2010): an integrating converter")
def integrating_converter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The mean over a window of two ``size`` band periods."""
    window = max(round(2.0 * size * conditions.time / SUBSTEP), 2)
    law = SignalLaw(_averaged, [0.0], np.zeros(3 + window), output=True)
    return Built(law, {"lag": 0.5 * (window - 1) * SUBSTEP})


@njit(cache=True)
def _second_order(c: Array, m: Array, y: Array) -> None:
    """A second-order low-pass (semi-implicit Euler) followed by a first-order one."""
    angular, damping, behind = c
    if m[0] == 0.0:
        m[0], m[1], m[2], m[3] = 1.0, y[0], 0.0, y[0]
    for k in range(y.shape[0]):
        m[2] += SUBSTEP * angular * (angular * (y[k] - m[1]) - 2.0 * damping * m[2])
        m[1] += SUBSTEP * m[2]
        m[3] += SUBSTEP / (behind + SUBSTEP) * (m[1] - m[3])
        y[k] = m[3]


@tuning("Bentley, Principles of Measurement Systems (2005): a seismic element behind a filter")
def seismic_element(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A sensor of third order whose delay at low frequency is ``size`` band periods."""
    mean, damping = size * conditions.time, rng.uniform(0.55, 1.2)
    behind = rng.uniform(0.1, 0.4) * mean
    constants = [2.0 * damping / (mean - behind), damping, behind]
    return Built(SignalLaw(_second_order, constants, np.zeros(4), output=True), {"lag": mean})


@njit(cache=True)
def _complex_poles(c: Array, m: Array, y: Array) -> None:
    """Sum complex first-order filters; c: (pole decay, turn, weights), m: started and states."""
    poles = c.shape[0] // 4
    if m[0] == 0.0:
        m[0] = 1.0
        for i in range(poles):
            m[1 + 2 * i], m[2 + 2 * i] = y[0], 0.0
    for k in range(y.shape[0]):
        value = 0.0
        for i in range(poles):
            a, b, p, q = c[4 * i], c[4 * i + 1], c[4 * i + 2], c[4 * i + 3]
            x, z = m[1 + 2 * i] - y[k], m[2 + 2 * i]
            m[1 + 2 * i], m[2 + 2 * i] = a * x - b * z + y[k], b * x + a * z
            value += p * m[1 + 2 * i] - q * m[2 + 2 * i]
        y[k] = value


@reporting("Thomson, Proc. IEE 96 (1949) 487: a Bessel filter of fourth order")
def bessel_filter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A Bessel filter of fourth order whose delay at low frequency is ``size`` band periods."""
    from scipy.signal import besselap, residue

    mean = size * conditions.time
    _, poles, gain = besselap(4, norm="delay")
    weights, poles, _ = residue([gain], np.poly(poles))
    # Each pole is a filter of unit gain; those of a conjugate pair give twice its real part.
    kept = poles.imag > 0.0
    weights, poles = 2.0 * weights[kept] / -poles[kept], poles[kept]
    steps = np.exp(poles * SUBSTEP / mean)
    constants = np.column_stack([steps.real, steps.imag, weights.real, weights.imag]).ravel()
    return Built(SignalLaw(_complex_poles, constants, np.zeros(5), output=True), {"lag": mean})


@reporting("Kerlin et al., ISA Trans. 17 (1978): a probe of which a part is in direct contact")
def sheathed_probe(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A part of the probe responds quickly, the rest through its sheath."""
    quick, mean = rng.uniform(0.1, 0.35), size * conditions.time
    slow = 0.97 * mean / (1.0 - quick)
    law = parallel(
        0.0, np.array([quick, 1.0 - quick]), np.array([0.03 * mean / quick, slow]), output=True
    )
    return Built(law, {"lag": mean})


EFFECTS = (
    EffectKind(
        "slew_limit", Port.INPUT, 0.05, 6.0, "band periods per range",
        (differential_pair, trapezoidal_speed, orifice_flow, foldback_current),
    ),
    EffectKind(
        "transport_delay", Port.INPUT, 0.004, 0.6, "band periods",
        (pure_delay, jittered_delay, dispersed_plug_flow),
    ),
    EffectKind(
        "electrode_lag", Port.INPUT, 0.01, 1.0, "band periods",
        (cable_diffusion, two_stages, cole_cole, stretched_electrode),
    ),
    EffectKind(
        "sensor_lag", Port.OUTPUT, 0.01, 1.0, "band periods",
        (seismic_element, integrating_converter, bessel_filter, sheathed_probe),
    ),
)  # fmt: skip
