"""A tracked model's frequency responses at the times at which others were measured without it."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from dea.arrays import Array
from dea.gfrf.bands import ResponseBand, frequency_response_band
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
        ``track.nc`` of one tracker. Where it withholds the covariance, the bands have no width, so
        that those of the measurement decide.
    responses
        ``gfrf.nc`` of the track, which says what the structure lacks.
    stretches
        Of the probed record.
    frequencies
        The measured lines, ascending, in Hz, shape (lines,). The second-order response is taken at
        all pairs of them and of their negatives.
    sampling_rate
        In Hz.
    """
    pairs = np.concatenate([-frequencies[::-1], frequencies])
    lacking = [
        np.interp(frequencies, responses["frequency"].values, np.nan_to_num(responses[name].values))
        for name in ("model_error_gain", "model_error_phase")
    ]
    withheld = str(track["withheld"].values)
    found = []
    for stretch in stretches:
        now = track.sel(instant=stretch.time, method="nearest")
        theta = now["parameter"].sel(time=now["instant"], method="nearest").values.astype(float)
        covariance = now["covariance"].values
        first, second = (
            frequency_response_band(
                model,
                order,
                at,
                sampling_rate,
                parameters=theta,
                covariance=np.zeros_like(covariance) if withheld else covariance,
                operating_point=float(stretch.u.mean()),
                allow_missing=True,
            )
            for order, at in ((1, frequencies), (2, (pairs[:, None], pairs[None, :])))
        )
        first = first.widened(lacking[0], np.radians(lacking[1]))
        found.append(Modelled(first.response, _band(first), second.response, _band(second)))
    return found


def _band(of: ResponseBand) -> RelativeBand:
    return RelativeBand.around(of.response, of.gain_high, of.phase_high)
