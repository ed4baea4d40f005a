"""What a tracker found, as a labelled dataset."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dea import store
from dea.arrays import Array
from dea.narx import LEVEL, NarxModel, quantile
from dea.tracking.random_walk import lead_in


class TrackerEstimate(NamedTuple):
    """What a tracker found, of the samples after the largest lag.

    ``theta`` and ``std`` (n, p), ``innovation`` (n,), ``covariance`` (k, p, p) at the instants,
    ``estimator`` the method that the estimate is of, ``withheld`` why no interval holds, and
    ``noise_ratio`` (p,) of a smoother the variance of a step over that of the noise.
    """

    theta: Array
    std: Array
    innovation: Array
    covariance: Array
    estimator: str
    withheld: str
    noise_ratio: Array | None = None


def track_dataset(
    model: NarxModel,
    found: TrackerEstimate,
    at: NDArray[np.int64],
    sampling_rate: float,
    settings: dict[str, Any],
) -> xr.Dataset:
    """Return a track as :func:`dea.track_parameters` does.

    ``at`` are the samples (k,) at which the covariance was kept, ``sampling_rate`` is in Hz.
    """
    lag = model.max_lag
    theta = lead_in(found.theta, lag)
    innovation = np.concatenate([np.full(lag, np.nan), found.innovation * model.scaling.y_scale])
    covariance = np.full_like(found.covariance, np.nan) if found.withheld else found.covariance
    reach = quantile(LEVEL) * np.sqrt(np.maximum(np.einsum("kii->ki", covariance), 0.0))
    over, at_instants = ("time", "term"), ("instant", "term")
    normalised = "of the parameter, normalised signals"
    attrs = {name: value for name, value in settings.items() if name != "noise_ratio"}
    track = xr.Dataset(
        {
            "parameter": store.variable(
                over, theta, "1", "parameter of the term, normalised signals"
            ),
            "parameter_std": store.variable(
                over,
                lead_in(found.std, lag),
                "1",
                f"standard deviation {normalised}, for white noise",
            ),
            "covariance": store.variable(
                ("instant", "term", "term_2"), covariance, "1", "covariance of the parameters"
            ),
            "band_low": store.variable(
                at_instants, theta[at] - reach, "1", f"lower end of the 95 % interval {normalised}"
            ),
            "band_high": store.variable(
                at_instants, theta[at] + reach, "1", f"upper end of the 95 % interval {normalised}"
            ),
            "innovation": (
                "time",
                innovation,
                {"long_name": "prediction error of the tracker, missing until all lags are known"},
            ),
        },
        coords={
            "time": store.variable(
                "time", np.arange(innovation.size) / sampling_rate, "s", "time since the start"
            ),
            "instant": store.variable("instant", at / sampling_rate, "s", "time of a covariance"),
            "term": store.variable("term", list(map(str, model.terms)), "1", "term"),
        },
        attrs=attrs | {"estimator": found.estimator, "withheld": found.withheld},
    )
    if found.noise_ratio is not None:
        label = "variance of a step over that of the noise, per sample"
        track["noise_ratio"] = store.variable("term", found.noise_ratio, "1", label)
    return track
