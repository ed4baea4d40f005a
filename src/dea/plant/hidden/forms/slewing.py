"""Slew limits of the command."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
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
def _clipped_lag(c: Array, m: Array, u: Array) -> None:
    """Follow as a first-order lag whose rates upwards and downwards are clipped."""
    rise, fall, share = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        m[1] += min(max(share * (u[k] - m[1]), -SUBSTEP * fall), SUBSTEP * rise)
        u[k] = m[1]


@tuning("Gray et al., Analysis and Design of Analog Integrated Circuits (2001): a class A follower")
def class_a_follower(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An output that rises at once and falls at the rate of a constant bias current."""
    rate = _rate(size, conditions)
    share = -np.expm1(-SUBSTEP / (0.005 * conditions.time))
    return Built(SignalLaw(_clipped_lag, [np.inf, rate, share], [0.0, 0.0]), {"rate": rate})


@tuning("Stevens and Lewis, Aircraft Control and Simulation (2003): a servo with a limited rate")
def rate_limited_servo(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A first-order lag of 0.04 to 0.15 times the time for the range, its rate clipped."""
    rate = _rate(size, conditions)
    time = rng.uniform(0.04, 0.15) * size * conditions.time
    constants = [rate, rate, -np.expm1(-SUBSTEP / time)]
    return Built(SignalLaw(_clipped_lag, constants, [0.0, 0.0]), {"rate": rate})


@njit(cache=True)
def _steps(c: Array, m: Array, u: Array) -> None:
    """Move in equal steps; m holds whether started, the place and the time since the last step."""
    step, interval = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        m[2] = min(m[2] + SUBSTEP, interval + SUBSTEP)
        while m[2] >= interval and abs(u[k] - m[1]) > 0.5 * step:
            m[1] += step * np.sign(u[k] - m[1])
            m[2] -= interval
        u[k] = m[1]


@tuning("Acarnley, Stepping Motors (2002): steps at a limited rate")
def stepping_motor(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A place that moves in steps of 0.3 to 1 thousandths of the range, so many a second."""
    rate = _rate(size, conditions)
    step = rng.uniform(0.0003, 0.001) * conditions.span
    return Built(SignalLaw(_steps, [step, step / rate], np.zeros(3)), {"rate": rate})


@njit(cache=True)
def _smoothed_ramp(c: Array, m: Array, u: Array) -> None:
    """Follow at a bounded rate, then take the mean; m: started, target, place, sum and a ring."""
    most, length = SUBSTEP * c[0], m.shape[0] - 4
    if m[0] == 0.0:
        m[0], m[1], m[3] = 1.0, u[0], length * u[0]
        m[4:] = u[0]
    place = int(m[2])
    for k in range(u.shape[0]):
        m[1] += min(max(u[k] - m[1], -most), most)
        m[3] += m[1] - m[4 + place]
        m[4 + place] = m[1]
        place = (place + 1) % length
        u[k] = m[3] / length
    m[2] = place


@tuning("Biagiotti and Melchiorri, Control Eng. Pract. 20 (2012) 1385: a ramp, then a moving mean")
def smoothed_ramp(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A bounded rate, of which the mean over 0.05 to 0.25 times the time for the range is taken."""
    rate = _rate(size, conditions)
    window = max(round(rng.uniform(0.05, 0.25) * size * conditions.time / SUBSTEP), 2)
    return Built(SignalLaw(_smoothed_ramp, [rate], np.zeros(4 + window)), {"rate": rate})


@njit(cache=True)
def _switched_motor(c: Array, m: Array, u: Array) -> None:
    """Run at c[0] from an error of c[1] on until it is gone; m: started, place and direction."""
    step, band = SUBSTEP * c[0], c[1]
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        if m[2] == 0.0 and abs(error) > band:
            m[2] = np.sign(error)
        if m[2] != 0.0 and m[2] * error > step:
            m[1] += m[2] * step
        elif m[2] != 0.0:
            m[1] = u[k] if m[2] * error > 0.0 else m[1]
            m[2] = 0.0
        u[k] = m[1]


@tuning("Isermann, Digital Control Systems (1989): a motor of constant speed, switched on and off")
def switched_motor(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A motor that starts when its error exceeds 0.2 to 0.8 hundredths of the range."""
    rate = _rate(size, conditions)
    band = rng.uniform(0.002, 0.008) * conditions.span
    return Built(SignalLaw(_switched_motor, [rate, band], np.zeros(3)), {"rate": rate})


@njit(cache=True)
def _ringing(c: Array, m: Array, u: Array) -> None:
    """Integrate the limited error, behind it a lag, which is fed back; m: started and both."""
    rate, gain, share = c
    if m[0] == 0.0:
        m[0], m[1], m[2] = 1.0, u[0], u[0]
    for k in range(u.shape[0]):
        m[1] += SUBSTEP * min(max(gain * (u[k] - m[2]), -rate), rate)
        m[2] += share * (m[1] - m[2])
        u[k] = m[2]


@tuning("Chuang, IEEE J. Solid-State Circuits 17 (1982) 74: slewing, then settling with ringing")
def ringing_amplifier(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A bounded rate, then a swing of second order of 0.1 to 0.3 times the time for the range."""
    rate, damping = _rate(size, conditions), rng.uniform(0.3, 0.6)
    period = max(rng.uniform(0.1, 0.3) * size * conditions.time, 25.0 * SUBSTEP)
    angular = 2.0 * np.pi / period
    share = -np.expm1(-SUBSTEP * 2.0 * damping * angular)
    constants = [rate, 0.5 * angular / damping, share]
    return Built(SignalLaw(_ringing, constants, np.zeros(3)), {"rate": rate})


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


@tuning("Merritt, Hydraulic Control Systems (1967): flow through an orifice, valve fully open")
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


@tuning("Horowitz and Hill, The Art of Electronics (2015): charging by a current with foldback")
def foldback_current(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The nearer the output to the end it moves to, the slower the rate."""
    rate = _rate(size, conditions)
    middle, half = 0.5 * (conditions.low + conditions.high), 0.5 * conditions.span
    constants = [rate, rng.uniform(0.15, 0.4), middle, half]
    return Built(SignalLaw(_foldback, constants, [0.0, 0.0]), {"rate": rate})


@njit(cache=True)
def _saturable(c: Array, m: Array, u: Array) -> None:
    """Follow at c[0] e/(c[1] + e) for an error e, by Euler's implicit rule; m: started, place."""
    way, half = SUBSTEP * c[0], c[1]
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        rest = 0.5 * (half + way - abs(error))
        left = np.sqrt(rest * rest + half * abs(error)) - rest
        m[1] = u[k] - left * np.sign(error)
        u[k] = m[1]


@reporting("Michaelis and Menten, Biochem. Z. 49 (1913) 333: a carrier that saturates")
def saturable_carrier(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A rate that is half its limit at an error of 0.01 to 0.04 of the range."""
    rate = _rate(size, conditions)
    half = rng.uniform(0.01, 0.04) * conditions.span
    return Built(SignalLaw(_saturable, [rate, half], [0.0, 0.0]), {"rate": rate})


@njit(cache=True)
def _two_speeds(c: Array, m: Array, u: Array) -> None:
    """Follow at c[0], and within c[2] of the target at c[1]; m: started, place."""
    rate, slow, zone = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        most = SUBSTEP * (rate if abs(error) > zone else slow)
        m[1] += min(max(error, -most), most)
        u[k] = m[1]


@reporting(
    "Strakosch, Vertical Transportation: Elevators and Escalators (1967): a second, low speed"
)
def two_speed_lift(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A rate that is 3 to 8 times less within 0.02 to 0.08 of the range of the target."""
    rate = _rate(size, conditions)
    constants = [rate, rate / rng.uniform(3.0, 8.0), rng.uniform(0.02, 0.08) * conditions.span]
    return Built(SignalLaw(_two_speeds, constants, [0.0, 0.0]), {"rate": rate})


EFFECTS = (
    EffectKind(
        "slew_limit", Port.INPUT, 0.05, 6.0, "band periods per range",
        (differential_pair, trapezoidal_speed, class_a_follower, rate_limited_servo, stepping_motor,
         smoothed_ramp, switched_motor, ringing_amplifier, orifice_flow, foldback_current,
         saturable_carrier, two_speed_lift),
    ),
)  # fmt: skip
