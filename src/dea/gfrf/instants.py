"""The parameters of a track, with their covariances, at its instants."""

from typing import NamedTuple, Self

import numpy as np
import xarray as xr

from dea.arrays import Array
from dea.errors import InputError
from dea.narx import NarxModel


class Instants(NamedTuple):
    """Times in s, (instants,), parameters (instants, terms), covariances (instants, terms, terms).

    The covariances are missing where the track withholds its intervals.
    """

    time: Array
    theta: Array
    covariance: Array

    @classmethod
    def of(cls, track: xr.Dataset, model: NarxModel) -> Self:
        """Return them of a track of this model, as :func:`dea.track_parameters` gives it.

        Raises
        ------
        InputError
            If the track is of other terms.
        """
        terms = list(map(str, model.terms))
        if track["term"].values.tolist() != terms:
            raise InputError(
                f"its terms are {track['term'].values.tolist()}",
                field="track",
                remedy=f"The model's terms are {terms}",
            )
        time = track["instant"].values
        theta = track["parameter"].sel(time=time, method="nearest").transpose("time", "term")
        covariance = track["covariance"].transpose("instant", "term", "term_2").values
        if track.attrs["withheld"]:
            covariance = np.full_like(covariance, np.nan)
        return cls(time, theta.values.astype(float), covariance)
