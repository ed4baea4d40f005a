"""Something outside shakes the output at a fixed frequency."""

import numpy as np

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.parameter import Parameter

_HARMONICS = 5


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Add a wave of five harmonics whose size may grow with the output."""
    phase = 2.0 * np.pi * q[0] * t
    wave = np.zeros_like(y)
    for n in range(_HARMONICS):
        wave += q[1 + 2 * n] * np.cos((n + 1) * phase) + q[2 + 2 * n] * np.sin((n + 1) * phase)
    growth, middle, half = q[1 + 2 * _HARMONICS :]
    return y + wave * (1.0 + growth * (y - middle) / half)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return frequency, amplitudes, growth with the output, and the output's middle and half."""
    unit, size = scales.y_unit, 0.03 * scales.y_span
    middle, half = 0.5 * (scales.y_low + scales.y_high), 0.5 * scales.y_span
    nyquist = 0.5 / scales.interval
    frequency = scales.frequencies[0] if scales.frequencies else 0.1 * nyquist
    return (
        Parameter("frequency", "Hz", frequency, 0.1 / scales.duration, 0.0, nyquist),
        *(
            Parameter(f"{part}_{n + 1}", unit, 0.0, size)
            for n in range(_HARMONICS)
            for part in ("cosine", "sine")
        ),
        Parameter("growth", "1", 0.0, 0.3, -1.0, 1.0),
        Parameter("middle", unit, middle, 0.0),
        Parameter("half_range", unit, half, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return the frequencies at which the gap of the nominal simulation peaks."""
    middle, half = 0.5 * (scales.y_low + scales.y_high), 0.5 * scales.y_span
    # So small that the first step finds amplitude and phase before the frequency moves.
    size = 1e-5 * scales.y_span
    return tuple(
        (frequency, size, *(0.0,) * (2 * _HARMONICS), middle, half)
        for frequency in scales.frequencies
    )


EFFECT = Effect(
    name="periodic_disturbance",
    port=Port.OUTPUT,
    family=Family.OSCILLATION,
    signature="the gap oscillates at one frequency that the input does not have",
    citation="Rife and Boorstyn (1974), IEEE Transactions on Information Theory 20:591",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
