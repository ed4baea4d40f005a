"""The offset of the output drifts."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import DRIFT_DEGREES, drift
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Add a polynomial of time."""
    result: np.ndarray = y + drift(t, q[DRIFT_DEGREES], q[:DRIFT_DEGREES])
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the weights of Legendre polynomials of time."""
    return (
        *(
            Parameter(f"degree_{n}", scales.y_unit, 0.0, 0.1 * scales.y_span)
            for n in range(1, DRIFT_DEGREES + 1)
        ),
        Parameter("duration", "s", scales.duration, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a slow rise; the law is linear in its weights."""
    return ((0.02 * scales.y_span, *(0.0,) * (DRIFT_DEGREES - 1), scales.duration),)


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
