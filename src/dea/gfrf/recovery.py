"""How closely an identified model agrees with a known plant."""

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.gfrf.response import frequency_response
from dea.narx import NarxModel, nmse

_LINES = 25  # frequencies on each axis at which responses are compared


def score_recovery(
    plant: NarxModel, found: NarxModel, u: ArrayLike, sampling_rate: float, band: float
) -> dict[str, float]:
    """Compare a model with the plant that its record came from.

    The simulated output and the frequency responses must agree; terms need not, because
    neighbouring lags of a smooth signal are nearly interchangeable.

    Parameters
    ----------
    u
        Input of an independent record in physical units, shape (samples,); both models simulate
        it from rest, free of noise.
    sampling_rate, band
        In Hz; responses are compared up to ``band``.

    Returns
    -------
    dict
        ``nmse`` of the simulated output; ``h1_error`` and ``h2_error``, the root mean square
        difference of the frequency responses over the root mean square of the plant's;
        ``terms_common``, how many of the plant's terms the model has, and ``terms_foreign``, how
        many terms it has that the plant does not. Errors are infinite where the model diverges or
        does not come to rest.
    """
    frequencies = band * np.arange(1, _LINES + 1) / _LINES
    plane = (frequencies[:, None], frequencies[None, :])
    known = set(plant.terms) & set(found.terms)
    # Both runs start from zero, which is not the plant's rest; the start-up transient is left out.
    settled = len(np.asarray(u)) // 10
    return {
        "nmse": nmse(plant.simulate(u)[settled:], found.simulate(u)[settled:]),
        "h1_error": _difference(plant, found, 1, frequencies, sampling_rate),
        "h2_error": _difference(plant, found, 2, plane, sampling_rate),
        "terms_common": len(known),
        "terms_foreign": len(found.terms) - len(known),
    }


def _difference(
    plant: NarxModel,
    found: NarxModel,
    order: int,
    frequencies: Array | tuple[Array, Array],
    sampling_rate: float,
) -> float:
    expected, actual = (
        frequency_response(model, order, frequencies, sampling_rate, allow_missing=True)
        for model in (plant, found)
    )
    error, size = np.linalg.norm(actual - expected), np.linalg.norm(expected)
    if error == 0.0:
        return 0.0  # of two linear models, whose responses of higher order vanish, too
    return float(error / size) if size and np.isfinite(error / size) else np.inf
