"""Frequency responses of a model whose parameters change, as one labelled dataset."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.errors import InputError
from dea.gfrf.excited_band import excited, input_spectrum
from dea.gfrf.response import frequency_response, zero_input_response
from dea.narx import NarxModel


@dataclass(frozen=True)
class Grid:
    """Where responses are taken: frequencies as shares of the sampling rate, and times.

    Parameters
    ----------
    instants
        At how many times, evenly spread, H1 is taken; at every sample of a shorter record.
    lowest, highest, count
        H1 is taken at ``count`` frequencies from ``lowest`` to ``highest``, in equal ratios.
    plane_highest, plane_count, plane_times
        H2 and H3 are taken at ``plane_count`` frequencies each way, up to ``plane_highest`` in
        equal steps, at times given as shares of the record.
    third_frequency
        Of H3(f1, f2, f3).
    """

    instants: int = 360
    lowest: float = 4e-4
    highest: float = 0.1
    count: int = 100
    plane_highest: float = 0.04
    plane_count: int = 60
    plane_times: Sequence[float] = (0.1, 0.5, 0.9)
    third_frequency: float = 0.01


_GRID = Grid()


def response_over_time(
    model: NarxModel,
    parameters: xr.DataArray,
    u: ArrayLike,
    sampling_rate: float,
    *,
    grid: Grid = _GRID,
    excited_above: float = 1e-3,
) -> xr.Dataset:
    """Return H1 through the record, H2 and H3 on a plane of frequencies at a few times.

    Parameters
    ----------
    parameters
        Over (time, term), as a tracker gives them.
    u, sampling_rate
        The excitation the parameters were tracked with, in physical units, and its rate in Hz.
    grid
        Times and frequencies of the responses.
    excited_above
        Share of the largest power density of the excitation above which a frequency counts as
        excited.

    Returns
    -------
    xarray.Dataset
        ``H1(time, frequency, part)``, ``H2`` and ``H3(time_h2, frequency_1, frequency_2, part)``,
        ``y0(time)``, ``input_spectrum(frequency)``, ``excited(frequency)`` and
        ``excited_h2(frequency_1, frequency_2)``. Missing where the model of that time does not
        come to rest and has no steady-state response.
    """
    terms = list(map(str, model.terms))
    if parameters["term"].values.tolist() != terms:
        raise InputError(
            f"they are of the terms {parameters['term'].values.tolist()}",
            field="parameters",
            remedy=f"The model's terms are {terms}",
        )
    samples = parameters.sizes["time"]
    at = np.arange(min(grid.instants, samples))
    at = at * samples // at.size + samples // (2 * at.size)
    at_plane = np.rint(np.asarray(grid.plane_times) * (samples - 1)).astype(int)
    f = sampling_rate * np.geomspace(grid.lowest, grid.highest, grid.count)
    steps = np.arange(1, grid.plane_count + 1)
    plane = sampling_rate * grid.plane_highest * steps / grid.plane_count
    f1, f2 = plane[:, None], plane[None, :]
    f3 = sampling_rate * grid.third_frequency
    theta = parameters.transpose("time", "term").values.astype(float)

    def response(order: int, rows: NDArray[np.int64], *frequencies: ArrayLike) -> np.ndarray:
        H = frequency_response(
            model, order, frequencies, sampling_rate, parameters=theta[rows], allow_missing=True
        )
        return np.stack([H.real, H.imag], axis=-1)

    y0 = zero_input_response(model, parameters=theta[at], allow_missing=True)
    density, density_plane = (input_spectrum(u, sampling_rate, x) for x in (f, plane))
    largest = max(density.max(), density_plane.max())
    on_plane = excited(density_plane, excited_above * largest)
    planes = ("time_h2", "frequency_1", "frequency_2", "part")
    hertz = {"units": "Hz"}
    return xr.Dataset(
        {
            "H1": (
                ("time", "frequency", "part"),
                response(1, at, f),
                {"long_name": "first-order frequency response"},
            ),
            "H2": (
                planes,
                response(2, at_plane, f1, f2),
                {"long_name": "second-order frequency response"},
            ),
            "H3": (
                planes,
                response(3, at_plane, f1, f2, f3),
                {"long_name": "third-order frequency response at (f1, f2, frequency_3)"},
            ),
            "y0": ("time", y0, {"long_name": "output at rest at the middle input"}),
            "input_spectrum": (
                "frequency",
                density,
                {"long_name": "power spectral density of the excitation"},
            ),
            "excited": (
                "frequency",
                excited(density, excited_above * largest).astype(np.int8),
                {"units": "1", "long_name": "1 where the excitation holds power"},
            ),
            "excited_h2": (
                ("frequency_1", "frequency_2"),
                (on_plane[:, None] & on_plane).astype(np.int8),
                {
                    "units": "1",
                    "long_name": "1 where both frequencies hold power and so reach their sum",
                },
            ),
        },
        coords={
            "time": ("time", parameters["time"].values[at], parameters["time"].attrs),
            "frequency": ("frequency", f, hertz | {"long_name": "frequency"}),
            "time_h2": ("time_h2", parameters["time"].values[at_plane], parameters["time"].attrs),
            "frequency_1": ("frequency_1", plane, hertz | {"long_name": "first frequency"}),
            "frequency_2": ("frequency_2", plane, hertz | {"long_name": "second frequency"}),
            "frequency_3": ((), f3, hertz | {"long_name": "third frequency of H3"}),
            "part": ("part", ["real", "imag"], {"units": "1", "long_name": "part"}),
        },
    )
