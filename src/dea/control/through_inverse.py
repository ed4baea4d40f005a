"""What a feedback through the inverse of a model acts on."""

import numpy as np

from dea.arrays import Array
from dea.control.planning import RecedingHorizonInverse
from dea.gfrf import ResponseBand

_SMALL = 1e-5  # of the scales: a change whose effect on the inputs is linear


def inverse_response(
    inverse: RecedingHorizonInverse, u: float, y: float, band: ResponseBand, z: Array
) -> Array:
    """Return the response Q(z) of the inverse's first input to what is added to its reference.

    Around a rest the inverse is linear: u = f_v v + sum_k (p_k u_{t-k} + q_k y_{t-k}), where y is
    the model's, so that Q = f_v / (1 - sum_k z^{-k} (p_k + q_k H)).

    Parameters
    ----------
    u, y
        Input and output of the rest.
    band
        Its ``response`` is that of the inverse's model there, at the points ``z``.
    """
    wanted = np.full(inverse.horizon, y)
    scaling = inverse.model.of_one_input("A controller")
    du, dy = _SMALL * scaling.u_scale, _SMALL * scaling.y_scale

    def moved(added: float = 0.0, past: tuple[int, float, float] | None = None) -> float:
        inverse.rest(u, y)
        if past is not None:
            inverse.shift(*past)
        found = inverse.step(wanted + added)
        return np.nan if found is None else found

    still = moved()
    loop = np.ones_like(z, dtype=complex)
    for k in range(1, inverse.past + 1):
        by_input = (moved(past=(k, du, 0.0)) - still) / du
        by_output = (moved(past=(k, 0.0, dy)) - still) / dy
        loop -= z**-k * (by_input + by_output * band.response)
    response: Array = (moved(dy) - still) / dy / loop
    return response


def band_through_inverse(
    inverse: RecedingHorizonInverse, u: float, y: float, band: ResponseBand, z: Array
) -> ResponseBand:
    """Return the band of what a feedback through the inverse acts on, z^{-1} Q(z) H(z).

    A measurement acts one sample later, through the inverse's response Q on the actuator's H, whose
    band is that of the model.

    Parameters
    ----------
    u, y
        Input and output of the rest.
    band
        Of H1 there, at the points ``z``.
    """
    factor = inverse_response(inverse, u, y, band, z) / z
    size, angle = np.abs(factor), np.degrees(np.angle(factor))
    return band._replace(
        response=band.response * factor,
        gain_low=band.gain_low * size,
        gain_high=band.gain_high * size,
        phase_low=band.phase_low + angle,
        phase_high=band.phase_high + angle,
    )
