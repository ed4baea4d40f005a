"""Lags of a thermometer in still air, a voltmeter, an oxygen probe and particles in a flow."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, reporting, tuning
from dea.plant.hidden.forms.kernels import cascade
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _convected(c: Array, m: Array, y: Array) -> None:
    """Follow at a rate that is a power 1 + c[1] of the error, exactly at a held output.

    c[0]: the rate in a sub-step at an error of c[2]; m: started and value.
    """
    share, power, scale = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0]
    for k in range(y.shape[0]):
        error = y[k] - m[1]
        lessened = 1.0 + power * share * (abs(error) / scale) ** power
        m[1] = y[k] - error * lessened ** (-1.0 / power)
        y[k] = m[1]


@tuning("McAdams, Heat Transmission (1954): natural convection, a power 5/4 or 4/3")
def still_air(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A thermometer in still air, laminar or turbulent, slower as it comes near.

    At an error of 0.05 to 0.3 travels it is a lag of ``size`` band periods.
    """
    scale = rng.uniform(0.05, 0.3) * conditions.travel
    constants = [SUBSTEP / (size * conditions.time), rng.choice([1.0 / 4.0, 1.0 / 3.0]), scale]
    return Built(SignalLaw(_convected, constants, [0.0, 0.0], output=True), {})


@njit(cache=True)
def _shown(c: Array, m: Array, y: Array) -> None:
    """Show the mean over each c[0] values when the last has come, and before the first value.

    m: count, sum, what is shown, and whether started.
    """
    if m[3] == 0.0:
        m[2], m[3] = y[0], 1.0
    for k in range(y.shape[0]):
        m[0] += 1.0
        m[1] += y[k]
        if m[0] == c[0]:
            m[2], m[0], m[1] = m[1] / c[0], 0.0, 0.0
        y[k] = m[2]


@tuning("Oliver and Cage, Electronic Measurements and Instrumentation (1971): a digital voltmeter")
def digital_voltmeter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Means over windows of ``size`` band periods, each shown until the next is there."""
    window = max(round(size * conditions.time / SUBSTEP) + 1, 2)
    law = SignalLaw(_shown, [window], np.zeros(4), output=True)
    return Built(law, {"lag": (window - 1) * SUBSTEP})


@reporting("Mancy et al., J. Electroanal. Chem. 4 (1962) 65: the membrane of an oxygen probe")
def oxygen_probe(size: float, conditions: Conditions, rng: Generator) -> Built:
    """What has diffused through a membrane, by thirty poles, late by ``size`` band periods.

    It is x/sinh x of the concentration outside, x² being s in units of the time of diffusion.
    """
    mean = size * conditions.time
    times = 1.0 / np.arange(1.0, 31.0) ** 2
    return Built(cascade(mean * times / times.sum(), output=True), {"lag": mean})


@njit(cache=True)
def _dragged(c: Array, m: Array, y: Array) -> None:
    """Follow at a rate 1 + (|error|/c[1])^0.687 over c[0] s, exactly at a held output.

    m: started and value.
    """
    power = 0.687
    grown = np.exp(power * SUBSTEP / c[0])
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0]
    for k in range(y.shape[0]):
        error = y[k] - m[1]
        more = (abs(error) / c[1]) ** power
        m[1] = y[k] - error * ((1.0 + more) * grown - more) ** (-1.0 / power)
        y[k] = m[1]


@reporting("Clift et al., Bubbles, Drops, and Particles (1978): the drag of particles in a flow")
def tracer_particles(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Particles that are seen instead of the flow: small errors lag by ``size`` band periods.

    Larger ones lag less, by 1 + 0.15 Re^0.687; at an error of a travel Re is 20 to 200.
    """
    reynolds = rng.uniform(20.0, 200.0)
    scale = 0.15 ** (-1.0 / 0.687) / reynolds * conditions.travel
    law = SignalLaw(_dragged, [size * conditions.time, scale], [0.0, 0.0], output=True)
    return Built(law, {})
