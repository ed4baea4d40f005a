"""Track the parameters of a model through a record, by name of the method."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.errors import InputError
from dea.narx import NarxModel, regressor_matrix
from dea.tracking.kalman import Smoothed
from dea.tracking.output_error import free_run, smooth_simulation
from dea.tracking.random_walk import RandomWalk, lead_in, root_mean_square
from dea.tracking.rls import recursive_least_squares
from dea.tracking.structure import with_constant
from dea.tracking.success import normalised_record

Array = NDArray[np.float64]
_SMOOTHER = {"delta": 1.0, "noise_ratio": None, "thinning": 10}
_DEFAULTS: dict[str, dict[str, Any]] = {
    "rls": {"forgetting": 0.999, "leakage": 1e-4, "delta": 1.0},
    "kalman": _SMOOTHER,
    "output_error": _SMOOTHER,
}
METHODS = tuple(_DEFAULTS)


def track_parameters(
    model: NarxModel,
    u: ArrayLike,
    y: ArrayLike,
    *,
    method: str = "rls",
    forgetting: float | None = None,
    leakage: float | None = None,
    delta: float | None = None,
    noise_ratio: ArrayLike | None = None,
    thinning: int | None = None,
    sampling_rate: float = 1.0,
) -> xr.Dataset:
    """Track the parameters of ``model`` through a record, (10).

    Regressors are scaled to a root mean square of one, so that one setting holds for all terms. A
    constant is added where the model has none; see :func:`dea.tracking.with_constant`.

    Parameters
    ----------
    u, y
        Measured input and output in physical units, shape (samples,).
    method
        ``rls``: recursive least squares (11)-(16) with forgetting and leakage towards the model's
        own parameters; uses the past alone. ``kalman``: random-walk Kalman filter and smoother;
        each estimate uses the whole record. ``output_error``: the same smoother on the free run
        instead of the one-step prediction, starting from ``kalman``; unbiased where the output is
        noisy.
    forgetting, leakage
        lambda and alpha of ``rls``, by default 0.999 and 1e-4; the memory is 1/(1 - lambda)
        samples.
    delta
        The model's own parameters count like a record of ``delta`` samples, by default 1:
        P_0 = I/delta.
    noise_ratio
        For the other two, variance of a parameter's step over that of the noise, a number or one
        per term; fitted by likelihood where it is not given.
    thinning
        For the other two, of the samples that the likelihood is taken over, by default 10; about
        the number of samples over which one-step prediction errors are correlated.
    sampling_rate
        In Hz; only labels the time.

    Returns
    -------
    xarray.Dataset
        ``parameter(time, term)`` and ``parameter_std`` in the model's normalised units,
        ``innovation(time)`` in output units, missing for the first ``model.max_lag`` samples, and
        for the smoothers ``noise_ratio(term)``.

    Raises
    ------
    InputError
        If the record is not usable, a setting is out of range or unknown to the method, or
        ``output_error`` finds no bounded free run to start from.
    """
    chosen = _settings(
        method,
        forgetting=forgetting,
        leakage=leakage,
        delta=delta,
        noise_ratio=noise_ratio,
        thinning=thinning,
    )
    model = with_constant(model)
    inputs, outputs = normalised_record(model, u, y)
    Phi = regressor_matrix(model.terms, inputs, outputs)
    target = outputs[model.max_lag :]
    if method == "rls":
        scale = root_mean_square(Phi)
        found = recursive_least_squares(
            Phi / scale,
            target,
            theta_0=model.parameters * scale,
            **chosen,
        )
        return _labelled(
            model,
            found.theta / scale,
            np.sqrt(found.variance) / scale,
            found.innovation,
            sampling_rate,
            {"method": method, **chosen},
        )
    walk = RandomWalk(
        None if noise_ratio is None else np.asarray(noise_ratio, dtype=float),
        prior_variance=1.0 / chosen["delta"],
        thinning=chosen["thinning"],
    )
    smoothed = walk.smooth(Phi, target, model.parameters)
    if method == "output_error":
        fixed = RandomWalk(np.zeros(len(model.terms)), prior_variance=0.0)
        starts = [smoothed, fixed.smooth(Phi, target, model.parameters)]
        start = _bounded(model, starts, inputs, outputs)
        smoothed = smooth_simulation(model, start, inputs, outputs, walk)
    track = _labelled(
        model,
        smoothed.theta,
        np.sqrt(smoothed.variance),
        smoothed.innovation,
        sampling_rate,
        {"method": method, "delta": chosen["delta"], "thinning": chosen["thinning"]},
    )
    return track.assign(
        noise_ratio=(
            "term",
            smoothed.noise_ratio,
            {"units": "1", "long_name": "variance of a step over that of the noise, per sample"},
        )
    )


def _settings(method: str, **given: Any) -> dict[str, Any]:
    """Return the settings of ``method``, with defaults where nothing was given."""
    if method not in METHODS:
        raise InputError(f"{method!r} is unknown", field="method", remedy=f"One of {METHODS}")
    known = _DEFAULTS[method]
    for name, value in given.items():
        if value is not None and name not in known:
            others = [other for other in METHODS if name in _DEFAULTS[other]]
            raise InputError(
                f"the method {method!r} has no such setting",
                field=name,
                remedy=f"Leave it out, or take method={' or '.join(map(repr, others))}",
            )
    chosen = known | {name: given[name] for name in known if given[name] is not None}
    if not chosen["delta"] > 0.0:
        raise InputError(f"it is {chosen['delta']}", field="delta", remedy="It is more than zero")
    if chosen.get("thinning", 1) < 1:
        raise InputError(f"it is {chosen['thinning']}", field="thinning", remedy="It is 1 or more")
    return chosen


def _bounded(model: NarxModel, starts: list[Smoothed], u: Array, y: Array) -> Smoothed:
    """Return the one of ``starts`` with the smallest free-run error."""
    errors = [free_run(model, start.theta, u, y)[1] for start in starts]
    best = int(np.argmin(errors))
    if not np.isfinite(errors[best]):
        raise InputError(
            "the free run diverges with the model's own parameters and with tracked ones",
            field="model",
            remedy="Take a model that is stable on this record, or another method",
        )
    return starts[best]


def _labelled(
    model: NarxModel,
    theta: Array,
    std: Array,
    innovation: Array,
    sampling_rate: float,
    attrs: dict[str, Any],
) -> xr.Dataset:
    lag = model.max_lag
    before = np.full(lag, np.nan)
    innovations = np.concatenate([before, innovation * model.scaling.y_scale])
    plain = {"units": "1"}
    return xr.Dataset(
        {
            "parameter": (
                ("time", "term"),
                lead_in(theta, lag),
                plain | {"long_name": "parameter of the term, normalised signals"},
            ),
            "parameter_std": (
                ("time", "term"),
                lead_in(std, lag),
                plain | {"long_name": "standard deviation of the parameter"},
            ),
            "innovation": (
                "time",
                innovations,
                {"long_name": "one-step prediction error, missing until all lags are known"},
            ),
        },
        coords={
            "time": (
                "time",
                np.arange(innovations.size) / sampling_rate,
                {"units": "s", "long_name": "time since the start"},
            ),
            "term": ("term", list(map(str, model.terms)), plain | {"long_name": "term"}),
        },
        attrs=attrs,
    )
