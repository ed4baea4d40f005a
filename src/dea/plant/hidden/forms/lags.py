"""Lags of the electrode and of the sensor."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, tuning
from dea.plant.hidden.forms.electrode_lags import (
    charge_transfer,
    lognormal_times,
    stray_capacity,
    warming_composite,
)
from dea.plant.hidden.forms.kernels import cascade, parallel
from dea.plant.hidden.forms.sensor_lags import (
    digital_voltmeter,
    oxygen_probe,
    still_air,
    tracer_particles,
)
from dea.plant.signal_law import SignalLaw


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


@tuning("Nilsson and Riedel, Electric Circuits (2011): a series circuit of R, L and C")
def lead_inductance(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lag of second order that hardly overshoots; its mean delay is ``size`` band periods."""
    damping, mean = rng.uniform(0.8, 0.95), size * conditions.time
    angular = 2.0 * damping / mean
    pole = angular * complex(-damping, np.sqrt(1.0 - damping**2))
    step, weight = np.exp(pole * SUBSTEP), angular**2 / (1j * pole.imag * -pole)
    constants = [step.real, step.imag, weight.real, weight.imag]
    return Built(SignalLaw(_complex_poles, constants, np.zeros(3)), {"lag": mean})


@tuning(
    "Carslaw and Jaeger, Conduction of Heat in Solids (1959): a disc with a resistance at its rim"
)
def rim_contact(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The mean over a disc that is charged through its rim, of together ``size`` band periods."""
    from scipy.optimize import brentq
    from scipy.special import j0, j1, jn_zeros

    # The disc's resistance over that of its contact; roots of b J1(b) = ratio J0(b).
    ratio, mean = rng.uniform(2.0, 20.0), size * conditions.time
    below, above = np.append(0.0, jn_zeros(1, 19)), jn_zeros(0, 20)
    roots = np.array(
        [
            brentq(lambda b: b * j1(b) - ratio * j0(b), low, high)
            for low, high in zip(below, above, strict=True)
        ]
    )
    weights = 1.0 / (roots**2 * (roots**2 + ratio**2))
    weights /= weights.sum()
    times = roots**-2
    return Built(parallel(0.0, weights, mean * times / (weights @ times)), {"lag": mean})


@njit(cache=True)
def _bled(c: Array, m: Array, u: Array) -> None:
    """A first-order lag that passes a share c[0] rising, c[1] falling; m: started and value."""
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        m[1] += (c[0] if error > 0.0 else c[1]) * error
        u[k] = m[1]


@tuning("Horowitz and Hill, The Art of Electronics (2015): a bleeder that discharges alone")
def bleeder_resistor(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Discharge through a bleeder is two to five times as slow as the charge from the source."""
    ratio, mean = rng.uniform(2.0, 5.0), size * conditions.time
    quick = 2.0 * mean / (1.0 + ratio)
    shares = -np.expm1(-SUBSTEP / np.array([quick, quick * ratio]))
    return Built(SignalLaw(_bled, shares, [0.0, 0.0]), {})


@njit(cache=True)
def _tunnelled(c: Array, m: Array, u: Array) -> None:
    """Follow at a rate that is a sinh of the error over c[0], exactly at a held command."""
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        half = min(max(0.5 * (u[k] - m[1]) / c[0], -15.0), 15.0)
        m[1] = u[k] - 2.0 * c[0] * np.arctanh(c[1] * np.tanh(half))
        u[k] = m[1]


@tuning("Simmons, J. Appl. Phys. 34 (1963) 1793: tunnelling between the particles of an electrode")
def tunnelling_contacts(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lag of ``size`` band periods, ever less for errors above 0.05 to 0.3 of the range."""
    scale, time = rng.uniform(0.05, 0.3) * conditions.span, size * conditions.time
    return Built(SignalLaw(_tunnelled, [scale, np.exp(-SUBSTEP / time)], [0.0, 0.0]), {})


@tuning("Davidson and Cole, J. Chem. Phys. 19 (1951) 1484: times of relaxation up to a longest")
def davidson_cole(size: float, conditions: Conditions, rng: Generator) -> Built:
    """1/(1 + sT)^b as lags side by side, whose mean delay bT is ``size`` band periods."""
    from scipy.special import betaincinv

    exponent, mean = rng.uniform(0.4, 0.8), size * conditions.time
    # Their times over T have a beta distribution, here the middles of forty equal shares.
    times = betaincinv(exponent, 1.0 - exponent, (np.arange(40) + 0.5) / 40.0)
    times *= mean / times.mean()
    return Built(parallel(0.0, np.full(40, 1.0 / 40.0), times), {"lag": mean})


@njit(cache=True)
def _through_tubes(c: Array, m: Array, u: Array) -> None:
    """Follow at a rate that is a power 3/2 of the error, exactly at a held command.

    c: share that the root of the error is lessened by, times that root, in a sub-step.
    """
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        m[1] = u[k] - error / (1.0 + c[0] * np.sqrt(abs(error))) ** 2
        u[k] = m[1]


@tuning("Langmuir, Phys. Rev. 2 (1913) 450, after Child: a vacuum tube passes a power 3/2")
def vacuum_tubes(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A charge through one tube or the other, ever slower as it ends.

    For an error of 0.1 to 0.5 of the range it is a lag of ``size`` band periods.
    """
    scale, time = rng.uniform(0.1, 0.5) * conditions.span, size * conditions.time
    return Built(SignalLaw(_through_tubes, [0.5 * SUBSTEP / time / np.sqrt(scale)], [0.0, 0.0]), {})


@tuning("Cole and Cole, J. Chem. Phys. 9 (1941) 341: a distribution of relaxation times")
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


@tuning("Rosset and Shea, Appl. Phys. A 110 (2013) 281: electrodes whose resistance grows")
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


@tuning("Doebelin, Measurement Systems (2003): a thermometer, an instrument of first order")
def bare_thermometer(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A single lag of ``size`` band periods."""
    mean = size * conditions.time
    return Built(cascade(np.array([mean]), output=True), {"lag": mean})


@tuning("Carslaw and Jaeger, Conduction of Heat in Solids (1959): the insulated face of a slab")
def buried_sensor(size: float, conditions: Conditions, rng: Generator) -> Built:
    """1/cosh of the root of s, by its first twelve poles, of together ``size`` band periods."""
    mean = size * conditions.time
    times = 1.0 / (np.arange(12) + 0.5) ** 2
    return Built(cascade(mean * times / times.sum(), output=True), {"lag": mean})


@tuning("Carslaw and Jaeger, Conduction of Heat in Solids (1959): the mean over a sphere")
def thermistor_bead(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The mean over a sphere whose surface is heated, of together ``size`` band periods."""
    mean = size * conditions.time
    times = 1.0 / np.arange(1.0, 31.0) ** 2
    weights = 6.0 / np.pi**2 * times
    weights[-1] += 1.0 - weights.sum()
    law = parallel(0.0, weights, mean * times / (weights @ times), output=True)
    return Built(law, {"lag": mean})


@njit(cache=True)
def _turned(c: Array, m: Array, y: Array) -> None:
    """A first-order lag as quick as what it follows is large: c[1] s at one c[2] above c[0]."""
    calm, time, unit = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0]
    for k in range(y.shape[0]):
        wind = max((y[k] - calm) / unit, 0.05)
        m[1] -= np.expm1(-SUBSTEP / time * wind) * (y[k] - m[1])
        y[k] = m[1]


@tuning("Busch and Kristensen, J. Appl. Meteorol. 15 (1976) 1328: a cup anemometer that overspeeds")
def cup_anemometer(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lag of a constant length of wind: quick for much of it, slow for little.

    It is ``size`` band periods in the middle of the travel, with a calm 0.1 to 0.6 travels below.
    """
    below = (0.5 + rng.uniform(0.1, 0.6)) * conditions.travel
    calm = 0.5 * (conditions.bottom + conditions.top) - below
    law = SignalLaw(_turned, [calm, size * conditions.time, below], [0.0, 0.0], output=True)
    return Built(law, {})


@njit(cache=True)
def _combed(c: Array, m: Array, y: Array) -> None:
    """Moving means one after the other; m holds whether filled, place, and each one's sum and ring.

    c: how many means, and of how many values.
    """
    means, length = int(c[0]), int(c[1])
    if m[0] == 0.0:
        m[:] = y[0]
        m[0], m[1] = 1.0, 0.0
        m[2 :: 1 + length] = length * y[0]
    place = int(m[1])
    for k in range(y.shape[0]):
        for i in range(means):
            start = 2 + i * (1 + length)
            latest = start + 1 + place
            m[start] += y[k] - m[latest]
            m[latest] = y[k]
            y[k] = m[start] / length
        place = (place + 1) % length
    m[1] = place


@tuning(
    "Hogenauer, IEEE Trans. Acoust. Speech Signal Process. 29 (1981) 155: integrators and combs"
)
def comb_filter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Three to five equal moving means, as behind a modulator, late by ``size`` band periods."""
    means = int(rng.integers(3, 6))
    length = max(round(2.0 * size * conditions.time / means / SUBSTEP) + 1, 2)
    memory = np.zeros(2 + means * (1 + length))
    law = SignalLaw(_combed, [means, length], memory, output=True)
    return Built(law, {"lag": 0.5 * means * (length - 1) * SUBSTEP})


@njit(cache=True)
def _lit(c: Array, m: Array, y: Array) -> None:
    """Carriers n that light y frees and that meet in pairs: n' = c[1] (y - n²), at a held y.

    Light and reading n² are counted from the place c[0], in units of c[2].
    """
    dark, rate, unit = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, np.sqrt(max((y[0] - dark) / unit, 0.01))
    for k in range(y.shape[0]):
        end = np.sqrt(max((y[k] - dark) / unit, 0.01))
        passed = np.tanh(rate * end * SUBSTEP)
        m[1] = end * (m[1] + end * passed) / (end + m[1] * passed)
        y[k] = dark + unit * m[1] * m[1]


@tuning(
    "Rose, Concepts in Photoconductivity and Allied Problems (1963): carriers that meet in pairs"
)
def photoconductive_cell(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A cell that is slower in the dark, so that the last of a fall takes long.

    In the middle of the travel it is a lag of ``size`` band periods; darkness is 0.1 to 0.6
    travels below the travel.
    """
    below = (0.5 + rng.uniform(0.1, 0.6)) * conditions.travel
    dark = 0.5 * (conditions.bottom + conditions.top) - below
    constants = [dark, 0.5 / (size * conditions.time), below]
    return Built(SignalLaw(_lit, constants, [0.0, 0.0], output=True), {})


@tuning("Thomson, Proc. IEE 96 (1949) 487: a Bessel filter of fourth order")
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


@tuning("Kerlin et al., ISA Trans. 17 (1978): a probe of which a part is in direct contact")
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
        "electrode_lag", Port.INPUT, 0.01, 1.0, "band periods",
        (cable_diffusion, two_stages, lead_inductance, rim_contact, bleeder_resistor,
         tunnelling_contacts, davidson_cole, vacuum_tubes, cole_cole, stretched_electrode,
         stray_capacity, warming_composite, lognormal_times, charge_transfer),
    ),
    EffectKind(
        "sensor_lag", Port.OUTPUT, 0.01, 1.0, "band periods",
        (seismic_element, integrating_converter, bare_thermometer, buried_sensor, thermistor_bead,
         cup_anemometer, comb_filter, photoconductive_cell, bessel_filter, sheathed_probe,
         still_air, digital_voltmeter, oxygen_probe, tracer_particles),
    ),
)  # fmt: skip
