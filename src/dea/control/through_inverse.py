"""Feedback through the inverse of a model, tuned for every response in a band."""

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.control.feedback import Gains, tune_feedback
from dea.control.planning import RecedingHorizonInverse
from dea.errors import InputError
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


def tune_through_inverse(
    inverse: RecedingHorizonInverse,
    rests: list[tuple[float, float]],
    bands: list[ResponseBand],
    frequencies: Array,
    sampling_rate: float,
    *,
    integral_time: float,
    filter_time: float,
    largest_sensitivity: float,
) -> Gains:
    """Return the largest gain that keeps its margins at every rest, for every response in its band.

    The loop is C(z) z^{-1} Q(z) H(z): a measurement acts one sample later, through the inverse's
    response Q on the actuator's H, whose band is that of the model. :func:`tune_feedback` says what
    margins are.

    Parameters
    ----------
    inverse
        The inverse that the feedback acts through.
    rests
        Input and output of the rests over which the reference goes.
    bands
        Of H1 at each of them, at ``frequencies`` (Hz).
    frequencies
        Shape (frequencies,), in Hz.
    sampling_rate
        In Hz.
    integral_time, filter_time
        In s, as for :func:`tune_feedback`.
    largest_sensitivity
        Ms, which every response in its band keeps.

    Raises
    ------
    InputError
        As :func:`tune_feedback`; also where there is no rest.
    """
    if not rests:
        raise InputError(
            "the model rests at no output of the reference",
            field="rests",
            remedy="Identify it from a record that reaches as far, or narrow the reference.",
        )
    z = np.exp(2j * np.pi * frequencies / sampling_rate)
    found = [
        tune_feedback(
            _times(band, inverse_response(inverse, u, y, band, z) / z), frequencies, sampling_rate,
            integral_time=integral_time, filter_time=filter_time,
            largest_sensitivity=largest_sensitivity,
        )
        for (u, y), band in zip(rests, bands, strict=True)
    ]  # fmt: skip
    return min(found, key=lambda gains: abs(gains.proportional))


def _times(band: ResponseBand, factor: NDArray[np.complex128]) -> ResponseBand:
    size, angle = np.abs(factor), np.degrees(np.angle(factor))
    return band._replace(
        response=band.response * factor,
        gain_low=band.gain_low * size,
        gain_high=band.gain_high * size,
        phase_low=band.phase_low + angle,
        phase_high=band.phase_high + angle,
    )
