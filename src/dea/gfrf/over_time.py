"""Frequency responses of a model whose parameters change, as one labelled dataset."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from dea.arrays import Array, Indices
from dea.errors import InputError
from dea.gfrf.bands import ResponseBand, frequency_response_band, zero_input_interval
from dea.gfrf.excited_band import InputSpectrum
from dea.gfrf.instants import Instants, said_of
from dea.gfrf.model_error import ModelErrorModel, model_error
from dea.gfrf.response import frequency_response
from dea.inputs import by_input
from dea.instants import evenly_spread
from dea.narx import NarxModel, as_input, input_of
from dea.store import complex_parts, variable


class Frequencies(NamedTuple):
    """Where responses are taken, in Hz.

    H1 at ``first`` (k,); H2 and H3 at ``plane`` (m,) each way; H3 at the third frequency ``third``.
    """

    first: Array
    plane: Array
    third: float


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

    def frequencies(self, sampling_rate: float) -> Frequencies:
        """Return the frequencies at this rate in Hz."""
        steps = np.arange(1, self.plane_count + 1)
        return Frequencies(
            sampling_rate * np.geomspace(self.lowest, self.highest, self.count),
            sampling_rate * self.plane_highest * steps / self.plane_count,
            sampling_rate * self.third_frequency,
        )


_GRID = Grid()


def response_over_time(
    model: NarxModel,
    track: xr.Dataset,
    u: ArrayLike,
    sampling_rate: float,
    *,
    y: ArrayLike | None = None,
    grid: Grid = _GRID,
    excited_above: float = 1e-3,
) -> xr.Dataset:
    """Return H1 through the record, H2 and H3 on a plane of frequencies at a few times.

    Parameters
    ----------
    model
        With the terms of the track: :func:`dea.tracking.with_constant` of the model tracked.
    track
        Of :func:`dea.track_parameters`: ``parameter(time, term)``, ``covariance(instant, term,
        term_2)``, ``estimator`` and ``withheld``; or one tracker of ``track.nc``. Responses are
        taken at those of its instants that are nearest to the times of the grid.
    u, sampling_rate
        The excitation the parameters were tracked with, in physical units, and its rate in Hz.
    y
        The outputs they were tracked with, missing ones NaN: the intervals of H1 and H2 then hold
        what the model's structure lacks, too.
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
        ``excited_h2(frequency_1, frequency_2)``. The ends of the 95 % intervals are ``gain_low``,
        ``gain_high``, ``phase_low``, ``phase_high`` (degrees) of H1, the same with ``H2_`` of H2,
        ``y0_low`` and ``y0_high``. With ``y``, ``model_error_gain`` (relative) and
        ``model_error_phase`` (degrees) over frequency are the standard deviations that H1 has by
        the structure, the same with ``H2_`` those of what the square of the input drives at a
        frequency (:mod:`dea.gfrf.model_error`); missing, and not in the intervals, where the
        record does not tell. Of several inputs, H1, its intervals and errors, ``input_spectrum``,
        ``excited`` and H3, all of whose frequencies are then in one input, have the dimension
        ``input`` in front; H2, its intervals and errors and ``excited_h2`` the dimension ``pair``,
        of the input of ``frequency_1`` and that of ``frequency_2``. Missing where the model of that
        time does not come to rest and has no steady-state response; the intervals also where the
        track withholds them.
    """
    rows = _Rows(model, track, sampling_rate)
    u = input_of(model.labels, u)
    inputs = _each_input(model, u)
    error = None
    if y is not None:
        course = track["parameter"].transpose("time", "term").values.astype(float)
        error = model_error(model, course, u, y, sampling_rate, excited_above)
    time = rows.instants.time
    at, at_plane = rows.spread(grid.instants), rows.nearest(grid.plane_times)
    f, plane, f3 = frequencies = grid.frequencies(sampling_rate)
    f1, f2 = plane[:, None], plane[None, :]
    over, planes = ("time", "frequency"), ("time_h2", "frequency_1", "frequency_2")
    spectra = [_Spectrum(each, sampling_rate, f, plane, excited_above) for each in inputs]
    numbers = range(1, model.inputs + 1)
    pairs = list(combinations_with_replacement(numbers, 2))
    return xr.Dataset(
        _together(
            "input",
            [rows.first(at, f, over, k, error) for k in numbers],
        )
        | _together("pair", [rows.second(at_plane, (f1, f2), planes, k, error) for k in pairs])
        | ({} if y is None else _lacking_of(error, f, len(numbers), pairs))
        | rows.rest(at)
        | _together(
            "input",
            [
                rows.third(at_plane, (f1, f2, f3), planes, (k,) * 3) | spectra[k - 1].of_input()
                for k in numbers
            ],
        )
        | _together("pair", [spectra[i - 1].of_pair(spectra[j - 1]) for i, j in pairs]),
        coords=_of_inputs(model, pairs)
        | _coordinates(frequencies, time[at], time[at_plane], track["instant"].attrs),
        attrs={name: said_of(track, name) for name in ("estimator", "withheld")},
    )


class _Rows:
    """The parameters of a track, with their covariances, at its instants."""

    def __init__(self, model: NarxModel, track: xr.Dataset, sampling_rate: float) -> None:
        self._model, self._rate = model, sampling_rate
        self._end = float(track["time"].values[-1])
        self.instants = Instants.of(track, model)

    def spread(self, count: int) -> Indices:
        """Return ``count`` rows, evenly spread; every one of fewer."""
        return evenly_spread(self.instants.time.size, count)

    def nearest(self, shares: Sequence[float]) -> Indices:
        """Return the rows nearest to times given as shares of the record."""
        return self.instants.nearest(np.asarray(shares) * self._end)

    def first(
        self,
        at: Indices,
        f: Array,
        dims: tuple[str, ...],
        number: int,
        error: ModelErrorModel | None,
    ) -> dict[str, Any]:
        """Return the first-order response of an input, with what the structure lacks."""
        band = self.response(1, at, f, (number,))
        if error is not None:
            band = band.widened(*error.first(f, number))
        return _banded(band, "H1", dims)

    def second(
        self,
        at: Indices,
        frequencies: tuple[Array, Array],
        dims: tuple[str, ...],
        inputs: tuple[int, int],
        error: ModelErrorModel | None,
    ) -> dict[str, Any]:
        """Return the second-order response of a pair of inputs, with what the structure lacks."""
        band = self.response(2, at, frequencies, inputs)
        if error is not None:
            band = band.widened(*error.second(*frequencies, inputs))
        return _banded(band, "H2", dims, prefix="H2_")

    def response(
        self, order: int, at: Indices, frequencies: Any, inputs: tuple[int, ...]
    ) -> ResponseBand:
        """Return a response of this order with its band."""
        return frequency_response_band(
            self._model,
            order,
            frequencies,
            self._rate,
            inputs=inputs,
            parameters=self.instants.theta[at],
            covariance=self.instants.covariance[at],
            allow_missing=True,
        )

    def third(
        self, at: Indices, frequencies: Any, dims: tuple[str, ...], inputs: tuple[int, ...]
    ) -> dict[str, Any]:
        """Return the third-order response."""
        H3 = frequency_response(
            self._model,
            3,
            frequencies,
            self._rate,
            inputs=inputs,
            parameters=self.instants.theta[at],
            allow_missing=True,
        )
        return {
            "H3": (
                (*dims, "part"),
                complex_parts(H3),
                {"long_name": "third-order frequency response at (f1, f2, frequency_3)"},
            )
        }

    def rest(self, at: Indices) -> dict[str, Any]:
        """Return the rest and the ends of its interval."""
        y0, low, high = zero_input_interval(
            self._model,
            parameters=self.instants.theta[at],
            covariance=self.instants.covariance[at],
            allow_missing=True,
        )
        what = "output at rest at the middle input"
        return {
            "y0": ("time", y0, {"long_name": what}),
            "y0_low": ("time", low, {"long_name": f"lower end of the 95 % interval of the {what}"}),
            "y0_high": (
                "time", high, {"long_name": f"upper end of the 95 % interval of the {what}"}
            ),
        }  # fmt: skip


def _banded(
    band: ResponseBand, name: str, dims: tuple[str, ...], prefix: str = ""
) -> dict[str, Any]:
    """Return a response, and the ends of its intervals under names that begin with prefix."""
    words = "first" if name == "H1" else "second"
    H = band.response
    found = {
        name: (
            (*dims, "part"),
            complex_parts(H),
            {"long_name": f"{words}-order frequency response"},
        )
    }
    for quantity in ("gain", "phase"):
        for end, word in (("low", "lower"), ("high", "upper")):
            label = {"long_name": f"{word} end of the 95 % interval of the {quantity} of {name}"}
            if quantity == "phase":
                label["units"] = "degree"
            values = getattr(band, f"{quantity}_{end}")
            found[f"{prefix}{quantity}_{end}"] = (dims, values, label)
    return found


def _lacking_of(
    error: ModelErrorModel | None, f: Array, inputs: int, pairs: Sequence[tuple[int, int]]
) -> dict[str, Any]:
    """Return what the structure lacks in the responses to inputs and to their products."""
    unknown = (np.full(f.size, np.nan),) * 2
    numbers = range(1, inputs + 1)
    of_inputs = [unknown if error is None else error.first(f, k) for k in numbers]
    of_products = [unknown if error is None else error.product(f, pair) for pair in pairs]
    words = "what a product of inputs drives"
    return _together("input", [_lacking(each, "", "H1") for each in of_inputs]) | _together(
        "pair", [_lacking(each, "H2_", words) for each in of_products]
    )


def _lacking(found: tuple[Array, Array], prefix: str, of: str) -> dict[str, Any]:
    """Return the standard deviations of gain and phase (rad) by what the structure lacks."""
    gain, phase = found
    label = f"standard deviation of the {{}} of {of} by what the structure lacks"
    return {
        f"{prefix}model_error_gain": variable(
            ("frequency",), gain, "1", label.format("relative gain")
        ),
        f"{prefix}model_error_phase": variable(
            ("frequency",), np.degrees(phase), "degree", label.format("phase")
        ),
    }


def _each_input(model: NarxModel, u: ArrayLike) -> Array:
    """Return the excitation of each input of the model, shape (inputs, samples)."""
    inputs = by_input(as_input(u))
    if len(inputs) != model.inputs:
        raise InputError(
            f"it holds {len(inputs)} of {model.inputs} inputs",
            field="u",
            remedy="Give the inputs of the model in its order, as the columns of u.",
        )
    return inputs


def _of_inputs(model: NarxModel, pairs: Sequence[tuple[int, int]]) -> dict[str, Any]:
    """Return the coordinates that tell several inputs and their pairs apart; none for one."""
    if model.inputs == 1:
        return {}
    names = [name for name, _ in model.named_inputs]
    words = {"input": names, "pair": [f"{names[i - 1]} × {names[j - 1]}" for i, j in pairs]}
    labels = {"input": "input", "pair": "inputs of the first and the second frequency"}
    return {name: variable(name, values, "1", labels[name]) for name, values in words.items()}


def _coordinates(
    frequencies: Frequencies, time: Array, time_h2: Array, attrs: dict[Any, Any]
) -> dict[str, Any]:
    """Return times, which have these ``attrs``, frequencies and parts of responses."""
    first, plane, third = frequencies
    return {
        "time": ("time", time, attrs),
        "frequency": variable("frequency", first, "Hz", "frequency"),
        "time_h2": ("time_h2", time_h2, attrs),
        "frequency_1": variable("frequency_1", plane, "Hz", "first frequency"),
        "frequency_2": variable("frequency_2", plane, "Hz", "second frequency"),
        "frequency_3": variable((), third, "Hz", "third frequency of H3"),
        "part": variable("part", ["real", "imag"], "1", "part"),
    }


def _together(dimension: str, parts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the variables of all parts along a new dimension; of a single part as they are."""
    if len(parts) == 1:
        return parts[0]
    return {
        name: ((dimension, *dims), np.stack([part[name][1] for part in parts]), attrs)
        for name, (dims, _, attrs) in parts[0].items()
    }


class _Spectrum:
    """The spectrum of the excitation of an input, and where it holds power."""

    def __init__(
        self, u: Array, sampling_rate: float, f: Array, plane: Array, excited_above: float
    ) -> None:
        spectrum = InputSpectrum.of(u, sampling_rate)
        least = excited_above * spectrum.density.max()
        self._density = spectrum.at(f)
        self._excited = self._density > least
        self._on_plane = spectrum.at(plane) > least

    def of_input(self) -> dict[str, Any]:
        """Return the spectrum and the excited frequencies of H1."""
        return {
            "input_spectrum": (
                ("frequency",),
                self._density,
                {"long_name": "power spectral density of the excitation"},
            ),
            "excited": variable(
                ("frequency",),
                self._excited.astype(np.int8),
                "1",
                "1 where the excitation holds power",
            ),
        }

    def of_pair(self, other: "_Spectrum") -> dict[str, Any]:
        """Return the excited pairs of frequencies, the second in the ``other`` input."""
        return {
            "excited_h2": variable(
                ("frequency_1", "frequency_2"),
                (self._on_plane[:, None] & other._on_plane).astype(np.int8),
                "1",
                "1 where the input holds power at both frequencies",
            ),
        }
