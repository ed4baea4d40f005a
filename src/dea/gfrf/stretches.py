"""A tracked model's frequency responses at the times at which others were measured without it."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from dea.arrays import Array
from dea.gfrf.bands import ResponseBand, frequency_response_band
from dea.gfrf.instants import Instants
from dea.gfrf.model_error import ModelErrorModel
from dea.narx import NarxModel
from dea.nonparametric import Modelled, Periods, RelativeBand


def modelled_stretches(
    model: NarxModel,
    track: xr.Dataset,
    responses: xr.Dataset,
    stretches: Sequence[Periods],
    frequencies: Array,
    sampling_rate: float,
) -> list[Modelled]:
    """Return the responses of a model in each stretch, around the mean input there.

    Parameters
    ----------
    model
        With a constant, as it was tracked.
    track
        Of :func:`dea.track_parameters`, or one tracker of ``track.nc``. Where it withholds the
        covariance, the bands have no width, so that those of the measurement decide.
    responses
        Of :func:`dea.gfrf.response_over_time`, or ``gfrf.nc``. What the structure lacks is in the
        bands where it was made with the outputs.
    stretches
        Of the probed record.
    frequencies
        The measured lines, ascending, in Hz, shape (lines,). The second-order response is taken at
        all pairs of them and of their negatives.
    sampling_rate
        In Hz.
    """
    pairs = np.concatenate([-frequencies[::-1], frequencies])
    both = pairs[:, None], pairs[None, :]
    lacking = ModelErrorModel.of(responses)
    _, theta, covariance, withheld = instants = Instants.of(track, model)
    if withheld:
        covariance = np.zeros_like(covariance)
    found = []
    nearest = instants.nearest([stretch.time for stretch in stretches])
    for at, stretch in zip(nearest, stretches, strict=True):
        first, second = (
            frequency_response_band(
                model,
                order,
                where,
                sampling_rate,
                parameters=theta[at],
                covariance=covariance[at],
                operating_point=float(stretch.u.mean()),
                allow_missing=True,
            )
            for order, where in ((1, frequencies), (2, both))
        )
        if lacking is not None:
            first = first.widened(*lacking.first(frequencies))
            second = second.widened(*lacking.second(*both))
        found.append(Modelled(first.response, _band(first), second.response, _band(second)))
    return found


def _band(of: ResponseBand) -> RelativeBand:
    return RelativeBand.around(of.response, of.gain_high, of.phase_high)
