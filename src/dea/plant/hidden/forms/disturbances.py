"""Periodic disturbances of the reading, the command and the mass."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.force_laws.in_time import PULSES
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _harmonics(c: Array, m: Array, y: Array) -> None:
    """c: frequency, then (height, phase) of every harmonic; added to the signal."""
    count = (c.shape[0] - 1) // 2
    for k in range(y.shape[0]):
        angle = 2.0 * np.pi * c[0] * m[0]
        for i in range(count):
            y[k] += c[1 + 2 * i] * np.sin((i + 1) * angle + c[2 + 2 * i])
        m[0] += SUBSTEP


def _frequency(conditions: Conditions, rng: Generator) -> float:
    """Return a frequency from a fifth of the band to six times it.

    It stays so far below half the rate of the readings that its sidebands do too.
    """
    most = min(0.8, np.log10(0.4 * conditions.rate * conditions.time))
    return float(10.0 ** rng.uniform(-0.7, most) / conditions.time)


def _wave(
    size: float, conditions: Conditions, rng: Generator, shares: list[float], *, output: bool
) -> Built:
    frequency = _frequency(conditions, rng)
    heights = np.array(shares) * size * (conditions.travel if output else conditions.span)
    phases = rng.uniform(0.0, 2.0 * np.pi, heights.size)
    pairs = np.column_stack([heights, phases]).ravel()
    law = SignalLaw(_harmonics, np.concatenate([[frequency], pairs]), output=output)
    return Built(law, {"frequency": frequency})


@tuning("Den Hartog, Mechanical Vibrations (1956): the harmonics of a reciprocating machine")
def machine_harmonics(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A fundamental and two harmonics on the reading."""
    shares = [1.0, rng.uniform(0.0, 0.5), rng.uniform(0.0, 0.3)]
    return _wave(size, conditions, rng, shares, output=True)


@tuning("Mohan, Power Electronics (2003): ripple of a supply on the command")
def supply_ripple(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A fundamental and its second harmonic added to the command."""
    return _wave(size, conditions, rng, [1.0, rng.uniform(0.0, 0.5)], output=False)


@njit(cache=True)
def _sawtooth(c: Array, m: Array, u: Array) -> None:
    """c: height, frequency and phase (of 1) of a wave that falls in a line and jumps up."""
    for k in range(u.shape[0]):
        u[k] += c[0] * (1.0 - 2.0 * ((c[1] * m[0] + c[2]) % 1.0))
        m[0] += SUBSTEP


@tuning("Sedra and Smith, Microelectronic Circuits (2004): ripple of a capacitor after a rectifier")
def capacitor_ripple(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A sawtooth on the command."""
    frequency = _frequency(conditions, rng)
    law = SignalLaw(_sawtooth, [size * conditions.span, frequency, rng.random()])
    return Built(law, {"frequency": frequency})


@njit(cache=True)
def _tones(c: Array, m: Array, y: Array) -> None:
    """c: (height, frequency, phase) of every tone."""
    for k in range(y.shape[0]):
        for i in range(c.shape[0] // 3):
            y[k] += c[3 * i] * np.sin(2.0 * np.pi * c[3 * i + 1] * m[0] + c[3 * i + 2])
        m[0] += SUBSTEP


@tuning("McFadden, J. Vib. Acoust. 108 (1986) 165: the meshing of a gear, modulated by its turns")
def gear_meshing(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A sine on the reading with an amplitude that swings several times more slowly."""
    frequency, (phase, turned) = _frequency(conditions, rng), rng.uniform(0.0, 2.0 * np.pi, 2)
    height, depth = size * conditions.travel, rng.uniform(0.4, 1.0)
    turns = frequency * rng.uniform(0.05, 0.2)
    # sin a (1 + d sin b) = sin a + d/2 (cos(a - b) - cos(a + b))
    side, quarter = 0.5 * depth * height, 0.5 * np.pi
    constants = [
        height, frequency, phase,
        side, frequency - turns, phase - turned + quarter,
        side, frequency + turns, phase + turned - quarter,
    ]  # fmt: skip
    return Built(SignalLaw(_tones, constants, output=True), {"frequency": frequency})


@tuning("Muszynska, J. Sound Vib. 110 (1986) 443: the whirl of oil, slower than half the speed")
def oil_whirl(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A sine on the reading and a weaker one at 0.42 to 0.48 of its frequency."""
    frequency, phases = _frequency(conditions, rng), rng.uniform(0.0, 2.0 * np.pi, 2)
    height = size * conditions.travel
    constants = [
        height, frequency, phases[0],
        height * rng.uniform(0.4, 0.8), frequency * rng.uniform(0.42, 0.48), phases[1],
    ]  # fmt: skip
    return Built(SignalLaw(_tones, constants, output=True), {"frequency": frequency})


@njit(cache=True)
def _hunting(c: Array, m: Array, y: Array) -> None:
    """c: height, frequency and phase; swing, frequency and phase of what modulates the phase."""
    for k in range(y.shape[0]):
        swung = c[3] * np.sin(2.0 * np.pi * c[4] * m[0] + c[5])
        y[k] += c[0] * np.sin(2.0 * np.pi * c[1] * m[0] + c[2] + swung)
        m[0] += SUBSTEP


@tuning("Carson, Proc. IRE 10 (1922) 57: a modulated frequency, here of a machine that hunts")
def hunting_machine(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A sine on the reading whose phase swings by 0.3 to 0.9 several times more slowly."""
    frequency, phases = _frequency(conditions, rng), rng.uniform(0.0, 2.0 * np.pi, 2)
    constants = [
        size * conditions.travel, frequency, phases[0],
        rng.uniform(0.3, 0.9), frequency * rng.uniform(0.05, 0.2), phases[1],
    ]  # fmt: skip
    return Built(SignalLaw(_hunting, constants, output=True), {"frequency": frequency})


@njit(cache=True)
def _chopped(c: Array, m: Array, u: Array) -> None:
    """c: height, frequency, phase (of 1) and duty of rectangular pulses without a mean."""
    for k in range(u.shape[0]):
        on = 1.0 if (c[1] * m[0] + c[2]) % 1.0 < c[3] else 0.0
        u[k] += 2.0 * c[0] * (on - c[3])
        m[0] += SUBSTEP


@tuning("Rashid, Power Electronics (2004): the pulses of a chopper")
def chopped_supply(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Rectangular pulses on the command, on for 0.3 to 0.7 of the time."""
    frequency = _frequency(conditions, rng)
    constants = [size * conditions.span, frequency, rng.random(), rng.uniform(0.3, 0.7)]
    return Built(SignalLaw(_chopped, constants), {"frequency": frequency})


@njit(cache=True)
def _repeated(c: Array, m: Array, y: Array) -> None:
    """c: frequency and phase (of 1) of a wave, then its values over one period, the first twice."""
    points = c.shape[0] - 3
    for k in range(y.shape[0]):
        place = (c[0] * m[0] + c[1]) % 1.0 * points
        i = min(int(place), points - 1)
        y[k] += c[2 + i] + (place - i) * (c[3 + i] - c[2 + i])
        m[0] += SUBSTEP


def _limit_cycle(stiffening: float) -> Array:
    """Return a period of Van der Pol's oscillation, of height 1, at 400 places and the first."""
    from scipy.integrate import solve_ivp

    def slopes(t: float, s: Array) -> list[float]:
        return [s[1], stiffening * (1.0 - s[0] ** 2) * s[1] - s[0]]

    def rising(t: float, s: Array) -> float:
        return float(s[0])

    rising.direction = 1.0  # type: ignore[attr-defined]
    solved = solve_ivp(
        slopes, (0.0, 20.0 * (2.0 + stiffening)), [2.0, 0.0], method="LSODA", rtol=1e-8,
        atol=1e-8, events=rising, dense_output=True,
    )  # fmt: skip
    start, end = solved.t_events[0][-2:]
    wave = solved.sol(np.linspace(start, end, 401))[0]
    value: Array = wave / np.abs(wave).max()
    return value


@tuning("Van der Pol, Phil. Mag. 2 (1926) 978: relaxation oscillations, here of a regulator")
def relaxation_oscillation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A wave on the reading that lingers at either side and then crosses quickly."""
    frequency, phase = _frequency(conditions, rng), rng.random()
    wave = size * conditions.travel * _limit_cycle(rng.uniform(1.5, 5.0))
    law = SignalLaw(_repeated, np.concatenate([[frequency, phase], wave]), output=True)
    return Built(law, {"frequency": frequency})


@njit(cache=True)
def _beat(c: Array, m: Array, y: Array) -> None:
    """Two lines of slightly different frequency."""
    height, first, second, share, phase = c
    for k in range(y.shape[0]):
        y[k] += height * (
            np.sin(2.0 * np.pi * first * m[0] + phase) + share * np.sin(2.0 * np.pi * second * m[0])
        )
        m[0] += SUBSTEP


@tuning("Randall, Vibration-based Condition Monitoring (2011): two machines that beat")
def beating_machines(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A line and a weaker one two to six beats a record away."""
    first = _frequency(conditions, rng)
    second = first + rng.uniform(2.0, 6.0) / conditions.duration
    constants = [
        size * conditions.travel, first, second, rng.uniform(0.2, 0.6), rng.uniform(0, 2 * np.pi)
    ]  # fmt: skip
    return Built(SignalLaw(_beat, constants, output=True), {"frequency": first})


@tuning("Hanselman, Brushless Permanent Magnet Motor Design (2003): cogging", moving=True)
def cogging(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Equal pulses of force, many harmonics of one frequency."""
    from scipy.special import i0e

    frequency = 10.0 ** rng.uniform(-0.7, 0.2) / conditions.time
    narrow = rng.uniform(2.0, 6.0)
    height = conditions.device_forces(size)
    phase = rng.uniform(0.0, 2.0 * np.pi)
    constants = [height, frequency, phase, narrow, i0e(narrow)]
    return Built(ForceLaw(PULSES, constants), {"frequency": frequency})


@tuning("Rao, Mechanical Vibrations (2017): the rectified sine of a loose contact")
def rectified_sine(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The positive half of a sine on the reading, by its first six harmonics."""
    frequency, phase = _frequency(conditions, rng), rng.uniform(0.0, 2.0 * np.pi)
    order = np.arange(1, 7)
    # max(sin, 0) = 1/π + sin/2 - (2/π) Σ cos(2k x)/(4k² - 1)
    even = np.where(order % 2 == 0, -2.0 / np.pi / (order**2 - 1.0 + (order == 1)), 0.0)
    heights = 2.0 * size * conditions.travel * np.where(order == 1, 0.5, even)
    phases = order * phase + np.where(order == 1, 0.0, 0.5 * np.pi)
    pairs = np.column_stack([heights, phases]).ravel()
    law = SignalLaw(_harmonics, np.concatenate([[frequency], pairs]), output=True)
    return Built(law, {"frequency": frequency})


@tuning("Rothbart, Cams (1956): a cam that rises and falls by cycloids, and dwells")
def cycloidal_cam(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A wave on the reading: up in 0.15 to 0.3 of the time, down in as much, and at rest below."""
    frequency, phase = _frequency(conditions, rng), rng.random()
    rise, fall = rng.uniform(0.15, 0.3), rng.uniform(0.15, 0.3)
    turned = np.linspace(0.0, 1.0, 401)

    def cycloid(share: Array) -> Array:
        x = np.clip(share, 0.0, 1.0)
        value: Array = x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi)
        return value

    wave = cycloid(turned / rise) - cycloid((turned - rise) / fall)
    wave = 2.0 * size * conditions.travel * (wave - 0.5 * (rise + fall))
    law = SignalLaw(_repeated, np.concatenate([[frequency, phase], wave]), output=True)
    return Built(law, {"frequency": frequency})


@reporting("Tsypkin, Relay Control Systems (1984): what a relay regulates, to and fro")
def relay_cycle(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Exponentials on the command, up in 0.3 to 0.7 of the time, each 0.5 to 2.5 times its time."""
    frequency, phase = _frequency(conditions, rng), rng.random()
    duty, bend = rng.uniform(0.3, 0.7), rng.uniform(0.5, 2.5)
    turned = np.linspace(0.0, 1.0, 401)
    up, down = np.minimum(turned / duty, 1.0), np.maximum(turned - duty, 0.0) / (1.0 - duty)
    wave = (np.expm1(-bend * up) - np.expm1(-bend * down)) / np.expm1(-bend) - 0.5
    wave = 2.0 * size * conditions.span * wave
    return Built(
        SignalLaw(_repeated, np.concatenate([[frequency, phase], wave])), {"frequency": frequency}
    )


@reporting("Korteweg and de Vries, Phil. Mag. 39 (1895) 422: cnoidal waves, here below a gauge")
def cnoidal_wave(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A wave on the reading, crests narrower than troughs: cn² at a parameter of 0.7 to 0.98."""
    from scipy.special import ellipj, ellipk

    frequency, phase = _frequency(conditions, rng), rng.random()
    narrow = rng.uniform(0.7, 0.98)
    wave = ellipj(2.0 * ellipk(narrow) * np.linspace(0.0, 1.0, 401), narrow)[1] ** 2
    wave = 2.0 * size * conditions.travel * (wave - wave[:-1].mean())
    law = SignalLaw(_repeated, np.concatenate([[frequency, phase], wave]), output=True)
    return Built(law, {"frequency": frequency})


EFFECTS = (
    EffectKind(
        "periodic_disturbance", Port.OUTPUT, 0.002, 1.0, "travels",
        (machine_harmonics, supply_ripple, capacitor_ripple, gear_meshing, oil_whirl,
         hunting_machine, chopped_supply, relaxation_oscillation, beating_machines, cogging,
         rectified_sine, cycloidal_cam, relay_cycle, cnoidal_wave),
    ),
)  # fmt: skip
