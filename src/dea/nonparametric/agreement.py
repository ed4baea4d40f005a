"""Whether a measured and a modelled response agree within the bands of both."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from dea.arrays import Array, Complex
from dea.confidence import LEVEL
from dea.nonparametric.best_linear import BestLinear
from dea.nonparametric.intermodulation import Intermodulation

# Radius of the circle that holds two independent normal errors in 95 %, over the half-width of the
# interval that holds one: roots of the chi-squared quantiles of two and of one degree of freedom.
_BOTH = float(np.sqrt(chdtri(2, 1.0 - LEVEL) / chdtri(1, 1.0 - LEVEL)))


class RelativeBand(NamedTuple):
    """Half-widths of the 95 % band of a modelled response, of its shape.

    The band of the gain is even in its logarithm: it goes from gain/(1 + half-width) to gain times
    (1 + half-width).
    """

    gain: Array  # the upper one, relative to the gain
    phase: Array  # rad

    @classmethod
    def around(cls, response: Complex, gain_high: Array, phase_high: Array) -> Self:
        """Return the band whose upper ends, in output units and degrees, are given."""
        phase = np.radians(phase_high) - np.angle(response)
        return cls(gain_high / np.abs(response) - 1.0, phase)

    def radius(self) -> Array:
        """Return the radius, relative to the gain, of the disc that stands for the band."""
        return np.asarray(_BOTH * np.sqrt(0.5 * (self.gain**2 + self.phase**2)))


class Agreement(NamedTuple):
    """Differences of a measured response from a modelled one, (lines,)."""

    gain: Array  # relative: 0.1 where the measured gain is 10 % higher
    phase: Array  # rad
    gain_band: Array  # half-width of the joint 95 % band, relative
    phase_band: Array  # rad
    inside: NDArray[np.bool_]  # whether gain and phase lie in their joint 95 % region


def compare_response(found: BestLinear, modelled: Complex, band: RelativeBand) -> Agreement:
    """Set a best linear approximation against a modelled response at its lines.

    Half-widths of measurement and model add as squares. A line is inside where the differences of
    gain and phase, over their half-widths, lie in the ellipse that holds both in 95 %.
    """
    quotient = found.response / modelled
    gain, phase = np.abs(quotient) - 1.0, np.angle(quotient)
    measured = found.half_width() / np.abs(found.response)
    gain_band = np.hypot(measured, band.gain)
    phase_band = np.hypot(measured, band.phase)
    inside = np.hypot(gain / gain_band, phase / phase_band) <= _BOTH
    return Agreement(gain, phase, gain_band, phase_band, inside)


def compare_intermodulation(found: Intermodulation, model_radius: Array) -> NDArray[np.bool_]:
    """Return whether each even line agrees with its prediction, (even lines,).

    ``model_radius`` is that of the 95 % disc of the second-order response, relative to it.
    """
    return np.asarray(np.abs(found.ratio - 1.0) <= np.hypot(found.radius, model_radius))
