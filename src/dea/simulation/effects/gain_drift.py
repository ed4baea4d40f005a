"""The gain of the device changes slowly with time."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import DRIFT_MODES, drift, drift_modes, drift_starts
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def law(t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the factor on the drive, a smooth course of time."""
    return np.maximum(1.0 + drift(t, q[DRIFT_MODES], q[:DRIFT_MODES]), 1e-3)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the modes of the course, the smoothest first."""
    return (
        *(
            Parameter(f"mode_{n}", "1", 0.0, 0.1 * spread, -2.0, 2.0)
            for n, spread in enumerate(drift_modes()[1], 1)
        ),
        Parameter("duration", "s", scales.duration, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return slow rises and falls."""
    return drift_starts(0.02, scales.duration)


EFFECT = Effect(
    name="gain_drift",
    port=Port.TIME,
    family=Family.AGEING,
    symptom="the same input moves the device more (or less) later in the record",
    citation="Ljung (1999), System Identification, section 11.2, on time-varying systems",
    parameters=parameters,
    starts=starts,
    scale_drive=law,
    transferable=False,
)
