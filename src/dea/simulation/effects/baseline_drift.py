"""The offset of the output drifts."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import DRIFT_MODES, drift, drift_modes, drift_starts
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Add a smooth course of time."""
    result: np.ndarray = y + drift(t, q[DRIFT_MODES], q[:DRIFT_MODES])
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the modes of the course, the smoothest first."""
    return (
        *(
            Parameter(f"mode_{n}", scales.y_unit, 0.0, 0.1 * spread * scales.y_span)
            for n, spread in enumerate(drift_modes()[1], 1)
        ),
        Parameter("duration", "s", scales.duration, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return slow rises and falls."""
    return drift_starts(0.02 * scales.y_span, scales.duration)


EFFECT = Effect(
    name="baseline_drift",
    port=Port.TIME,
    family=Family.AGEING,
    symptom="the residual changes slowly with time and does not depend on the input",
    citation="Bendat and Piersol (2010), Random Data, section 10.4, on trends",
    parameters=parameters,
    starts=starts,
    shape_output=law,
    transferable=False,
)
