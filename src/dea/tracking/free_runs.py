"""Free-run errors of tracked parameters, compared with those of the fixed model."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.missing import filled
from dea.narx import (
    LEVEL,
    NarxModel,
    as_signal,
    covariance_of,
    pair,
    quantile,
    simulate,
    simulate_varying,
)
from dea.store import variable
from dea.tracking.sensitivity import sensitivity
from dea.tracking.structure import with_constant

FIXED = "fixed"


def compare_free_runs(
    model: NarxModel,
    tracks: Mapping[str, xr.Dataset],
    u: ArrayLike,
    y: ArrayLike,
    *,
    window: int,
) -> xr.Dataset:
    """Simulate the whole record with the fixed and with every tracked set of parameters.

    A tracked free run is given only the first outputs, but its parameters were estimated from the
    whole record. ``nmse_frozen`` is a stricter measure: each stretch of ``window`` samples is
    simulated with the parameters of its middle sample held constant, so that parameters which
    follow the output within a stretch have no advantage. It is the median over the stretches.

    Parameters
    ----------
    model
        The fixed model.
    tracks
        Results of :func:`dea.tracking.track_parameters` by name.
    u, y
        The record in physical units, shape (samples,); missing outputs (NaN), and the first ones,
        which a run is given, are not scored.
    window
        Samples of a stretch; a shorter record is one stretch.

    Returns
    -------
    xarray.Dataset
        ``simulated(simulation, time)`` with ``simulated_low`` and ``simulated_high``, the 95 %
        interval that the uncertainty of the parameters gives the free run, missing where the
        parameters' own is withheld; ``rmse(simulation)`` in output units,
        ``nmse(simulation)`` and ``nmse_frozen(simulation)``, where nmse is the squared error over
        that of the mean. A run that diverges is ``inf`` from there on and so is its error.

    Raises
    ------
    InputError
        If the window is no longer than the largest lag, or the record does not fit the model.
    """
    signals = normalised_signals(model, u, y)
    inputs, outputs, seen = signals
    if window <= model.max_lag:
        raise InputError(
            f"a stretch of {window} samples",
            field="window",
            remedy=f"Give more than {model.max_lag} samples, the largest lag",
        )
    stretch = min(window, outputs.size)
    tracked = with_constant(model)
    fixed = np.broadcast_to(tracked.parameters, (outputs.size, len(tracked.terms)))
    trajectories = {FIXED: fixed} | {
        name: track["parameter"].values.astype(float) for name, track in tracks.items()
    }
    runs = [
        simulate_varying(tracked.terms, theta, inputs, outputs) for theta in trajectories.values()
    ]
    frozen = [_frozen_error(tracked, theta, signals, stretch) for theta in trajectories.values()]
    scored = seen & (np.arange(outputs.size) >= tracked.max_lag)
    spread, spread_of_stretches = np.var(outputs[scored]), np.var(outputs[seen])
    error = np.array([np.mean((run - outputs)[scored] ** 2) for run in runs])
    unknown = np.full((len(tracked.terms), len(tracked.terms)), np.nan)
    own = unknown if tracked.covariance is None else covariance_of(tracked)
    spreads = {FIXED: own[None]} | {name: _covariance_of(track) for name, track in tracks.items()}
    reach = np.stack(
        [
            _reach(tracked, theta, inputs, run, spreads[name])
            for (name, theta), run in zip(trajectories.items(), runs, strict=True)
        ]
    )
    return _dataset(
        list(trajectories),
        model.scaling.restore_output(np.stack(runs)),
        reach,
        nmse=error / spread,
        nmse_frozen=np.array(frozen) / spread_of_stretches,
        rmse=np.sqrt(error) * model.scaling.y_scale,
    )


def _dataset(
    names: list[str],
    simulated: Array,
    reach: Array,
    *,
    nmse: Array,
    nmse_frozen: Array,
    rmse: Array,
) -> xr.Dataset:
    """Return the runs (simulation, time) with half their intervals, and their errors by name."""
    return xr.Dataset(
        {
            "simulated": (
                ("simulation", "time"),
                simulated,
                {"long_name": "free-run simulation of the output"},
            ),
            "simulated_low": (
                ("simulation", "time"),
                simulated - reach,
                {"long_name": "lower end of the 95 % interval of the free run"},
            ),
            "simulated_high": (
                ("simulation", "time"),
                simulated + reach,
                {"long_name": "upper end of the 95 % interval of the free run"},
            ),
            "nmse": variable(
                "simulation", nmse, "1", "normalised mean square error of the free run"
            ),
            "nmse_frozen": variable(
                "simulation",
                nmse_frozen,
                "1",
                "the same over stretches with parameters held at their middle",
            ),
            "rmse": (
                "simulation",
                rmse,
                {"long_name": "root mean square error of the free run"},
            ),
        },
        coords={"simulation": variable("simulation", names, "1", "where the parameters come from")},
    )


class NormalisedSignals(NamedTuple):
    """Input and output in the units of the equation; ``y`` is interpolated where not ``seen``.

    Several inputs are the columns of ``u``.
    """

    u: Array
    y: Array
    seen: NDArray[np.bool_]

    @property
    def measured(self) -> Array:
        """The output, NaN where it is missing."""
        return np.where(self.seen, self.y, np.nan)


def normalised_signals(model: NarxModel, u: ArrayLike, y: ArrayLike) -> NormalisedSignals:
    """Return a record, whose missing outputs are NaN, in the units of the equation.

    Raises
    ------
    InputError
        As :meth:`dea.narx.NarxModel.predict`.
    """
    outputs, seen = filled(as_signal(y, "y", missing=True))
    inputs, _ = pair(model.labels, u, outputs, model.max_lag)
    return NormalisedSignals(
        model.scaling.normalise_input(inputs),
        model.scaling.normalise_output(outputs),
        seen,
    )


def _covariance_of(track: xr.Dataset) -> Array:
    """Return the covariances of a track at its instants, (k, terms, terms); NaN if withheld."""
    if "covariance" not in track:
        return np.full((1, track.sizes["term"], track.sizes["term"]), np.nan)
    found: Array = track["covariance"].values
    return np.full_like(found, np.nan) if track.attrs["withheld"] else found


def _reach(model: NarxModel, theta: Array, u: Array, run: Array, covariance: Array) -> Array:
    """Return half the 95 % interval of a free run, in output units, shape (samples,).

    Each sample takes the covariance of the part of the record that it lies in, of as many equal
    parts as there are covariances. A run that diverges has no interval.
    """
    if not np.isfinite(run[-1]) or not np.isfinite(covariance).all():
        return np.full(run.size, np.nan)
    psi = np.concatenate(
        [
            np.zeros((model.max_lag, len(model.terms))),
            sensitivity(model.terms, theta, u, run),
        ]
    )
    part = np.arange(run.size) * covariance.shape[0] // run.size
    variance = np.empty(run.size)
    for i, C in enumerate(covariance):
        here = part == i
        variance[here] = np.einsum("ij,jk,ik->i", psi[here], C, psi[here])
    reach: Array = quantile(LEVEL) * model.scaling.y_scale * np.sqrt(np.maximum(variance, 0.0))
    return reach


def _frozen_error(model: NarxModel, theta: Array, signals: NormalisedSignals, window: int) -> float:
    """Median over stretches of the mean squared error with each stretch's middle parameters."""
    errors = []
    u, y, seen = signals
    for first in range(0, y.size - window + 1, window):
        stretch = slice(first, first + window)
        parameters = np.ascontiguousarray(theta[first + window // 2])
        run = simulate(model.terms, parameters, u[stretch], y[stretch])
        scored = seen[stretch] & (np.arange(window) >= model.max_lag)
        if scored.any():
            errors.append(np.mean((run - y[stretch])[scored] ** 2))
    return float(np.median(errors))
