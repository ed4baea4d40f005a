"""Effects with states of their own that a catalogue of common effects does not hold."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, foreign, reporting, tuning
from dea.plant.hidden.forms.kernels import note, noted
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _uncertain(c: Array, m: Array, y: Array) -> None:
    """Read at times that are wrong by c[1:] s, along a line; each holds for c[0] sub-steps.

    m: count, and last output.
    """
    hold, last = int(c[0]), c.shape[0] - 1
    if m[0] == 0.0:
        m[1] = y[0]
    for k in range(y.shape[0]):
        speed = (y[k] - m[1]) / SUBSTEP
        m[1] = y[k]
        y[k] += c[1 + int(m[0]) // hold % last] * speed
        m[0] += 1.0


@reporting("Shinagawa et al., IEEE J. Solid-State Circuits 25 (1990) 220: jitter of what samples")
def aperture_jitter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Each reading is taken at a time that is wrong by ``size`` band periods."""
    hold = max(round(1.0 / (conditions.rate * SUBSTEP)), 1)
    wrong = size * conditions.time * rng.standard_normal(20_000)
    law = SignalLaw(_uncertain, np.append(hold, wrong), [0.0, 0.0], output=True)
    return Built(law, {})


@njit(cache=True)
def _sparking(c: Array, m: Array, u: Array) -> None:
    """Lose a share c[0] of the command at a spark, which decays in c[1] s.

    Sparks come with c[2] a second at the command c[4], in proportion to what exceeds c[3]; c[5:]
    are the amounts of such risk from one to the next. m: what is left of a spark, risk and spark.
    """
    for k in range(u.shape[0]):
        m[1] += SUBSTEP * c[2] * max(u[k] - c[3], 0.0) / (c[4] - c[3])
        if m[1] >= c[5 + int(m[2]) % (c.shape[0] - 5)]:
            m[0], m[1], m[2] = 1.0, 0.0, m[2] + 1.0
        u[k] *= 1.0 - c[0] * m[0]
        m[0] -= SUBSTEP / c[1] * m[0]


@reporting(
    "Trichel, Phys. Rev. 54 (1938) 1078: discharges that come the oftener the higher the voltage"
)
def sparking_supply(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Sparks in the upper half of the commands, each of which takes ``size`` away for a while.

    They come 0.5 to 3 times a band period at the highest command, and last 0.05 to 0.4.
    """
    rate, lasting = rng.uniform(0.5, 3.0) / conditions.time, rng.uniform(0.05, 0.4)
    above = conditions.high - 0.5 * conditions.span
    amounts = rng.exponential(1.0, 2000)
    constants = [min(size, 1.0), lasting * conditions.time, rate, above, conditions.high]
    return Built(SignalLaw(_sparking, [*constants, *amounts], np.zeros(3)), {})


@njit(cache=True)
def _charged(c: Array, m: Array, u: Array) -> None:
    """Multiply by a gain of the charge m[0], from 0 to 1, that has passed; c[0]: its change.

    c: besides, the command in the middle and what it fills the charge with in a sub-step.
    """
    for k in range(u.shape[0]):
        passed = c[2] * (u[k] - c[1])
        u[k] *= np.sqrt(max(1.0 + c[0] * (2.0 * m[0] - 1.0), 0.05))
        m[0] = min(max(m[0] + passed, 0.0), 1.0)


@tuning("Strukov et al., Nature 453 (2008) 80: a resistance of the charge that has passed")
def memristive_path(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gain that the integral of the command changes by up to ``size``, between two ends.

    Half the range of the command goes from end to end in 1 to 5 band periods.
    """
    time = rng.uniform(1.0, 5.0) * conditions.time
    middle = 0.5 * (conditions.low + conditions.high)
    constants = [size * rng.choice([-1.0, 1.0]), middle, SUBSTEP / (0.5 * conditions.span * time)]
    return Built(SignalLaw(_charged, constants, [0.5]), {})


@njit(cache=True)
def _geared(c: Array, m: Array, u: Array) -> None:
    """Multiply by c[0] in a gear that is in from a mean command of c[2] on, until it is below c[1].

    c[3]: share of a sub-step in the mean; m: started, mean and gear.
    """
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        m[1] += c[3] * (u[k] - m[1])
        if m[1] > c[2]:
            m[2] = 1.0
        elif m[1] < c[1]:
            m[2] = 0.0
        if m[2] == 1.0:
            u[k] *= c[0]


@reporting("Liberzon, Switching in Systems and Control (2003): switching with hysteresis")
def shifted_gear(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gain that is another, by ``size``, once the mean command has been high, until it is low.

    The mean is over 0.1 to 0.5 band periods; high and low are 0.06 to 0.2 of the range from 0.5.
    """
    apart = rng.uniform(0.06, 0.2) * conditions.span
    middle = 0.5 * (conditions.low + conditions.high)
    share = -np.expm1(-SUBSTEP / (rng.uniform(0.1, 0.5) * conditions.time))
    other = np.sqrt(max(1.0 + size * rng.choice([-1.0, 1.0]), 0.05))
    return Built(
        SignalLaw(_geared, [other, middle - apart, middle + apart, share], np.zeros(3)), {}
    )


@njit(cache=True)
def _echoed(c: Array, m: Array, y: Array) -> None:
    """Add a share c[0] of what was there c[1] sub-steps before; m: count and a ring of the past.

    What does not change is read as it is.
    """
    for k in range(y.shape[0]):
        note(m, y[k])
        y[k] = (y[k] + c[0] * noted(m, int(c[1]))) / (1.0 + c[0])


@reporting("Bogert, Healy and Tukey, in Time Series Analysis (1963) 209: a signal with its echo")
def echoed_reading(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A share ``size`` of the reading comes again 2 to 6 band periods later, or its negative."""
    steps = round(rng.uniform(2.0, 6.0) * conditions.time / SUBSTEP)
    constants = [size * rng.choice([-1.0, 1.0]), steps]
    return Built(SignalLaw(_echoed, constants, np.zeros(2 + steps), output=True), {})


@njit(cache=True)
def _stagnated(c: Array, m: Array, y: Array) -> None:
    """Add c[0] times the square of the speed; m: started and latest output."""
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0]
    for k in range(y.shape[0]):
        speed = (y[k] - m[1]) / SUBSTEP
        m[1] = y[k]
        y[k] += c[0] * speed * speed


@reporting(
    "Prandtl and Tietjens, Applied Hydro- and Aeromechanics (1934): dynamic pressure at a gauge"
)
def dynamic_pressure(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A reading that is wrong with the square of its speed, by ``size`` travels at the mean speed.

    It is too high or too low.
    """
    height = size * conditions.travel / conditions.speed**2 * rng.choice([-1.0, 1.0])
    return Built(SignalLaw(_stagnated, [height], [0.0, 0.0], output=True), {})


EFFECTS = (
    foreign(aperture_jitter, 0.0003, 0.3, "band periods"),
    foreign(sparking_supply, 0.01, 1.0),
    foreign(memristive_path, 0.002, 0.9),
    foreign(shifted_gear, 0.002, 0.9),
    foreign(echoed_reading, 0.005, 0.6),
    foreign(dynamic_pressure, 0.0003, 0.5, "travels"),
)
