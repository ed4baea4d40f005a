"""The material stiffens (or softens) with strain more than the simulation says."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import smooth_modes, spline
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY

# Pieces of the curve beside the power, the prior deviation of the second difference of its weights,
# and its modes: all but the straight one, which is the simulation's own stiffness.
_PIECES, _BEND = 9, 0.016
MODES = _PIECES + 1
# Places in the parameters: of the curve's modes, and of what follows.
_CURVE, _MIDDLE, _HALF = 2, 2 + MODES, 3 + MODES
# Part of the motion's range that the pieces of the curve cover.
_COVERED = 1.1


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Power law of the deflection from rest, and a smooth curve, whose weights are ``memory``.

    Beyond its range the curve goes on straight.
    """
    weights = memory[: _PIECES + 3]
    place = 0.5 * _PIECES * (1.0 + (z - q[_MIDDLE]) / q[_HALF])
    within = min(max(place, 0.0), float(_PIECES))
    slope = 0.0
    if place < 0.0:
        slope = 0.5 * (weights[2] - weights[0])
    elif place > _PIECES:
        slope = 0.5 * (weights[-1] - weights[-3])
    bent = q[_HALF] * (spline(within, weights) + slope * (place - within))
    return float(-q[0] * z * abs(z) ** (q[1] - 1.0) - bent)


def memory(q: np.ndarray) -> np.ndarray:
    """Return the weights of the curve."""
    state = np.zeros(MEMORY)
    state[: _PIECES + 3] = curve_modes()[0] @ q[_CURVE : _CURVE + MODES]
    return state


def curve_modes() -> tuple[np.ndarray, np.ndarray]:
    """Return the weights (k, m) of each mode of the curve, and the modes' prior deviations."""
    modes, deviations = smooth_modes(_PIECES, _BEND)
    return np.ascontiguousarray(modes[:, 1:]), deviations[1:]


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the stiffening at full deflection, its exponent, the curve's modes and its range."""
    return (
        Parameter("stiffening", "1", 0.0, 0.3, -1.0, 50.0),
        Parameter("exponent", "1", 5.0, 0.4, 1.5, 15.0, log=True, shape=True),
        *(
            Parameter(f"mode_{n}", "1", 0.0, spread, -2.0, 2.0, shape=n > 1)
            for n, spread in enumerate(curve_modes()[1], 1)
        ),
        Parameter("middle", "1", scales.z_middle, 0.0),
        Parameter("half_range", "1", 0.5 * _COVERED * scales.z_span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a weak cubic, a steep law, a softening, and curves that are bent either way."""
    end = (scales.z_middle, 0.5 * _COVERED * scales.z_span)

    def bent(size: float) -> tuple[float, ...]:
        return tuple(size * float(n == 0) for n in range(MODES))

    powers = ((0.05, 3.0), (0.2, 7.0), (-0.05, 3.0))
    return (
        *((*power, *bent(0.0), *end) for power in powers),
        *((0.0, 5.0, *bent(size), *end) for size in (0.03, -0.03)),
    )


EFFECT = Effect(
    name="strain_stiffening",
    port=Port.FORCE,
    family=Family.CURVE,
    symptom="large deflections fall short of (or exceed) the simulation, whatever the rate",
    citation="Gent (1996), Rubber Chemistry and Technology 69:59; Duffing (1918) for the cubic",
    parameters=parameters,
    starts=starts,
    force=force,
    memory=memory,
)
