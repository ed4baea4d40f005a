"""The parameters of a track, with their covariances, at its instants."""

from typing import NamedTuple, Self

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike

from dea.arrays import Array, Indices
from dea.errors import InputError
from dea.narx import NarxModel


class Instants(NamedTuple):
    """Times in s, (instants,), parameters (instants, terms), covariances (instants, terms, terms).

    The covariances are missing where the track withholds its intervals, and ``withheld`` says why.
    """

    time: Array
    theta: Array
    covariance: Array
    withheld: str

    @classmethod
    def of(cls, track: xr.Dataset, model: NarxModel) -> Self:
        """Return them of a track of this model.

        It is as :func:`dea.track_parameters` gives it, or one tracker of ``track.nc``.

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
        withheld = said_of(track, "withheld")
        if withheld:
            covariance = np.full_like(covariance, np.nan)
        return cls(time, theta.values.astype(float), covariance, withheld)

    def nearest(self, times: ArrayLike) -> Indices:
        """Return which instants are nearest to these times in s; of two as near, the later one."""
        at: Indices = pd.Index(self.time).get_indexer(np.asarray(times), method="nearest")
        return at


def said_of(track: xr.Dataset, name: str) -> str:
    """Return the text that a track has as an attribute, or as a variable in ``track.nc``."""
    return str(track[name].values) if name in track else str(track.attrs[name])
