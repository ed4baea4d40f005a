"""A periodic disturbance adds to the output."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

_HARMONICS = 5
_WANDERS = range(2, 7)
# Periods in a record by which two lines must differ at least.
_APART = 2.0
# Periods in a record from which the phase may change slowly: with fewer, such a wave is almost any
# course in time.
_MANY = 20.0


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Add a wave of five harmonics whose phase may change slowly, and two lines beside them.

    They may grow with the output: what disturbs the drive shows where the output is steep.
    """
    first = 1 + 2 * _HARMONICS + len(_WANDERS)
    wander, beside = list(q[1 + 2 * _HARMONICS : first]), q[first : first + 6].reshape(2, 3)
    growth, duration, middle, half = q[first + 6 :]
    if q[0] * duration < _MANY:
        wander = [0.0]
    slow = np.polynomial.legendre.legval(2.0 * t / duration - 1.0, [0.0, 0.0, *wander])
    turn = np.exp(1j * (2.0 * np.pi * q[0] * t + slow))
    # The harmonics are powers of the first: two transcendental functions instead of ten.
    cosines, sines = q[1 : 1 + 2 * _HARMONICS].reshape(-1, 2).T
    wave = np.polynomial.polynomial.polyval(turn, [0.0, *(cosines - 1j * sines)]).real
    for frequency, cosine, sine in beside:
        if cosine or sine:
            angle = 2.0 * np.pi * frequency * t
            wave += cosine * np.cos(angle) + sine * np.sin(angle)
    place = np.clip((y - middle) / half, -1.0, 1.0)
    result: np.ndarray = y + np.exp(growth * place) * wave
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return frequency, amplitudes, weights of Legendre polynomials of the phase, and growth.

    Before the growth a line where the residual has one that is no harmonic, and its mirror image:
    what modulates a wave gives it a sideband on either side. The amplitude grows by the square of
    e^growth over the range of the output.
    """
    unit, span, size = scales.y_unit, scales.y_span, 0.03 * scales.y_span
    nyquist = 0.5 / scales.interval
    frequency = next(iter(scales.foreign_frequencies), 0.1 * nyquist)
    resolved = 0.1 / scales.duration
    beside, opposite = _lines_beside(scales)
    return (
        Parameter("frequency", "Hz", frequency, resolved, 0.0, nyquist),
        *(
            Parameter(f"{part}_{n + 1}", unit, 0.0, size)
            for n in range(_HARMONICS)
            for part in ("cosine", "sine")
        ),
        *(Parameter(f"phase_{n}", "rad", 0.0, 0.3, shape=True) for n in _WANDERS),
        *_line("beside", beside, resolved, size, scales),
        *_line("opposite", opposite, resolved, size, scales),
        Parameter("growth", "1", 0.0, 0.5, -3.0, 3.0, shape=True),
        Parameter("duration", "s", scales.duration, 0.0),
        Parameter("middle", unit, scales.y_middle, 0.0),
        Parameter("half_range", unit, 0.5 * span, 0.0),
    )


def _line(
    name: str, frequency: float | None, resolved: float, size: float, scales: Scales
) -> tuple[Parameter, ...]:
    """Return frequency and amplitudes of a line, which are held where there is none."""
    there = float(frequency is not None)
    nyquist, unit = 0.5 / scales.interval, scales.y_unit
    return (
        Parameter(
            f"line_{name}", "Hz", frequency or 0.0, there * resolved, 0.0, nyquist, shape=True
        ),
        Parameter(f"cosine_{name}", unit, 0.0, there * size, shape=True),
        Parameter(f"sine_{name}", unit, 0.0, there * size, shape=True),
    )


def _lines_beside(scales: Scales) -> tuple[float | None, float | None]:
    """Return the first line (Hz) that is no harmonic of the leading one, and its mirror image."""
    leading, *others = scales.foreign_frequencies or (np.inf,)
    apart = _APART / scales.duration
    for frequency in others:
        order = min(max(round(frequency / leading), 1), _HARMONICS)
        if abs(frequency - order * leading) > apart:
            image = 2.0 * leading - frequency
            return frequency, image if image > apart else None
    return None, None


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return the frequencies at which the residual of the nominal simulation peaks, in four phases.

    A start more than 90 degrees out of phase would appear to explain nothing.
    """
    # So small that the first step finds amplitude and phase before the frequency moves.
    size = 1e-5 * scales.y_span
    middle, half = scales.y_middle, 0.5 * scales.y_span
    amplitudes = (0.0,) * (2 * _HARMONICS - 2 + len(_WANDERS))
    beside = [v for line in _lines_beside(scales) for v in (line or 0.0, 0.0, 0.0)]
    rest = (*amplitudes, *beside, 0.0, scales.duration, middle, half)
    return tuple(
        (frequency, *phase, *rest)
        for frequency in dict.fromkeys(scales.foreign_frequencies)
        for phase in ((size, 0.0), (0.0, size), (-size, 0.0), (0.0, -size))
    )


EFFECT = Effect(
    name="periodic_disturbance",
    port=Port.OUTPUT,
    family=Family.OSCILLATION,
    symptom="the residual oscillates at one frequency that the input does not have",
    citation="Rife and Boorstyn (1974), IEEE Transactions on Information Theory 20:591",
    parameters=parameters,
    starts=starts,
    shape_output=law,
    transferable=False,
    defining="frequency",
)
