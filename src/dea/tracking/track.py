"""Track the parameters of a model through a record, by name of the method."""

from math import floor
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea import store
from dea.arrays import Array
from dea.errors import InputError
from dea.instants import evenly_spread
from dea.narx import (
    NarxModel,
    check_variation,
    pair,
    rate_of,
    regressor_matrix,
)
from dea.tracking.bands import (
    LARGEST_CURVATURE,
    NOT_MOVED,
    NOT_SETTLED,
    TARGET_UNKNOWN,
    UNDETERMINED,
    WINDOWS_FAILED,
    WINDOWS_FEW,
    reason_to_withhold,
)
from dea.tracking.free_runs import NormalisedSignals, normalised_signals
from dea.tracking.kalman import Prior, Smoothed
from dea.tracking.local import (
    SEPARATE,
    curvature_of_windows,
    local_estimates,
    usual_window,
)
from dea.tracking.output_error import free_run, smooth_simulation
from dea.tracking.random_walk import RandomWalk, lead_in, root_mean_square
from dea.tracking.rls import recursion_covariance, recursive_least_squares
from dea.tracking.setting_checks import check_count, check_delta
from dea.tracking.structure import with_constant
from dea.tracking.track_dataset import TrackerEstimate, track_dataset
from dea.tracking.unknown_ratios import mean_common_ratio

_THINNING = 10
_SMOOTHER = {"delta": 1e-4, "noise_ratio": None, "thinning": _THINNING, "instants": 360}
_NAMES = {"kalman": "Kalman smoother", "fixed": "model's own parameters"}
_DEFAULTS: dict[str, dict[str, Any]] = {
    "rls": {"forgetting": 0.999, "leakage": 1e-4, "delta": 1.0, "instants": 360},
    "kalman": _SMOOTHER,
    "output_error": _SMOOTHER,
    "local": {"window": None, "instants": 360},
}
METHODS = tuple(_DEFAULTS)


def track_parameters(
    model: NarxModel,
    u: ArrayLike | store.Record,
    y: ArrayLike | None = None,
    *,
    method: str = "rls",
    forgetting: float | None = None,
    leakage: float | None = None,
    delta: float | None = None,
    noise_ratio: ArrayLike | None = None,
    thinning: int | None = None,
    window: int | None = None,
    instants: int | None = None,
    sampling_rate: float | None = None,
) -> xr.Dataset:
    """Track the parameters of ``model`` through a record, (10).

    Regressors are scaled to a root mean square of one, so that one setting holds for all terms. A
    constant is added where the model has none; see :func:`dea.tracking.with_constant`.

    Parameters
    ----------
    u, y
        Measured input and output in physical units, shape (samples,), or a :class:`dea.Record`
        alone. Several inputs are the columns of ``u``. A missing output is NaN; equations that it
        enters are left out.
    method
        ``rls``: recursive least squares (11)-(16) with forgetting and leakage towards the model's
        own parameters; uses samples up to that of the estimate, but for the scale of the
        regressors and the first ``model.max_lag`` samples, at which the first estimate stands.
        ``kalman``: random-walk Kalman filter and smoother; each estimate uses the whole record.
        ``output_error``: the same smoother on the free run
        instead of the one-step prediction, starting from ``kalman``; unbiased where the output is
        noisy. ``local``: the parameters that minimise the error of the free run over a window
        around each time.
    forgetting, leakage
        lambda and alpha of ``rls``, by default 0.999 and 1e-4; the memory is 1/(1 - lambda)
        samples.
    delta
        The model's own parameters count like a record of ``delta`` samples, by default 1:
        P_0 = I/delta.
    noise_ratio
        For the smoothers, variance of a parameter's step over that of the noise, a number or one
        per term; fitted by likelihood where it is not given.
    thinning
        For the smoothers, of the samples that the likelihood is taken over, by default 10; about
        the number of samples over which one-step prediction errors are correlated.
    window
        Samples of a window of ``local``, so short that the parameters' course is nearly straight
        within it: by default an eighth of the record, and no more than 4000, 80 s at 50 Hz. Fewer
        than eight windows give no intervals; a record shorter than a window is one window.
    instants
        At how many times, evenly spread, the whole covariance and the intervals are given; by
        default 360, at every sample of a shorter record.
    sampling_rate
        In Hz; only labels the time. By default that of the record or of the model's own record, and
        without one a sample counts as a second.

    Returns
    -------
    xarray.Dataset
        ``parameter(time, term)`` in the model's normalised units; its ``parameter_std`` as the
        recursion itself has it, which takes the noise for white and the prior for known;
        ``covariance(instant, term, term_2)`` and the 95 % interval ``band_low`` and
        ``band_high(instant, term)``; ``innovation(time)`` in output units, missing for the first
        ``model.max_lag`` samples; for the smoothers ``noise_ratio(term)``. Its attribute
        ``estimator`` names the method that the estimate is of, which differs from ``method`` where
        that fell back on another; ``withheld`` says why no interval can be given: ``covariance``,
        ``band_low`` and ``band_high`` are then missing (docs/method/bands.md).

    Raises
    ------
    InputError
        If the record is not usable, a setting is out of range or unknown to the method, or
        ``output_error`` or ``local`` finds no bounded free run to start from.
    """
    chosen = _settings(
        method,
        forgetting=forgetting,
        leakage=leakage,
        delta=delta,
        noise_ratio=noise_ratio,
        thinning=thinning,
        window=window,
        instants=instants,
    )
    model = with_constant(model)
    inputs, outputs = pair(model.labels, u, y, model.max_lag)
    check_variation([inputs], [outputs])
    signals = normalised_signals(model, inputs, outputs)
    if method == "local" and chosen["window"] is None:
        chosen["window"] = usual_window(model, signals.y.size)
    rate = _rate(model, u, sampling_rate)
    at = evenly_spread(signals.y.size, chosen.pop("instants"))
    tracker = {"rls": _recursive, "local": _local}.get(method, _smoothed)
    # Before the first equation the first estimate holds.
    of_equation = np.maximum(at - model.max_lag, 0)
    found = tracker(model, signals, of_equation, method, chosen)
    return track_dataset(model, found, at, rate, {"method": method, **chosen})


def _rate(model: NarxModel, u: ArrayLike | store.Record, given: float | None) -> float:
    """Return the sampling rate in Hz that labels the time, 1 where nothing tells it."""
    if given is None and isinstance(u, store.Record):
        given = u.sampling_rate
    unknown = given is None and model.labels.sampling_rate is None
    return 1.0 if unknown else rate_of(model.labels, given)


def _recursive(
    model: NarxModel,
    signals: NormalisedSignals,
    at: NDArray[np.int64],
    method: str,
    settings: dict[str, Any],
) -> TrackerEstimate:
    """Track by recursive least squares, without the equations that a missing output enters.

    It begins at the first equation there is, before which nothing tells how large the noise is.
    """
    Phi, target = _equations(model, signals)
    before = int(np.argmax(np.isfinite(target)))
    Phi, target, at = Phi[before:], target[before:], np.maximum(at - before, 0)
    there = np.isfinite(target)
    scale = root_mean_square(Phi)
    Phi = np.where(there[:, None], Phi / scale, 0.0)
    centre = model.parameters * scale
    found = recursive_least_squares(Phi, target, theta_0=centre, **settings)
    known = model.covariance is not None
    own = np.zeros((scale.size, scale.size)) if model.covariance is None else model.covariance
    ratio = mean_common_ratio(Phi, target, Prior(centre, 1.0), thinning=_THINNING)
    covariance = recursion_covariance(
        Phi,
        found,
        at,
        target_covariance=own * np.outer(scale, scale),
        walk=np.full(scale.size, ratio * np.var(found.innovation[there])),
    )
    withheld = reason_to_withhold(found.innovation, Phi, target)
    if settings["leakage"] and not known:
        withheld = withheld or TARGET_UNKNOWN
    withheld = withheld or _undetermined(model, signals)
    return TrackerEstimate(
        lead_in(found.theta / scale, before),
        lead_in(np.sqrt(found.variance) / scale, before),
        np.concatenate([np.full(before, np.nan), found.innovation]),
        covariance / np.outer(scale, scale),
        method,
        withheld,
    )


def _smoothed(
    model: NarxModel,
    signals: NormalisedSignals,
    at: NDArray[np.int64],
    method: str,
    settings: dict[str, Any],
) -> TrackerEstimate:
    """Track by a smoother, of the one-step prediction or of the free run."""
    Phi, target = _equations(model, signals)
    walk = RandomWalk(
        _noise_ratio(settings["noise_ratio"], model),
        prior_variance=1.0 / settings["delta"],
        thinning=settings["thinning"],
    )
    by_prediction = walk.smooth(Phi, target, model.parameters, at)
    estimator = "kalman"
    withheld = reason_to_withhold(by_prediction.innovation, Phi, target)
    smoothed = by_prediction
    if method == "output_error":
        standing = RandomWalk(np.zeros(len(model.terms)), prior_variance=0.0)
        starts = [by_prediction, standing.smooth(Phi, target, model.parameters, at)]
        names = ("kalman", "fixed")
        outputs = signals.measured
        outputs[: model.max_lag] = signals.y[: model.max_lag]
        best = _bounded(model, starts, signals.u, outputs)
        tracked = smooth_simulation(model, starts[best], signals.u, outputs, walk, at)
        smoothed = tracked.smoothed
        if tracked.reached:
            estimator, withheld = method, "" if tracked.settled else NOT_SETTLED
        else:
            estimator, withheld = names[best], NOT_MOVED.format(_NAMES[names[best]])
    withheld = withheld or _undetermined(model, signals)
    covariance = smoothed.covariance
    if smoothed is by_prediction and not withheld:
        covariance = walk.covariance(Phi, target, model.parameters, smoothed, at)
    return TrackerEstimate(
        smoothed.theta,
        np.sqrt(np.maximum(smoothed.variance, 0.0)),
        smoothed.innovation,
        covariance,
        estimator,
        withheld,
        smoothed.noise_ratio,
    )


def _noise_ratio(given: ArrayLike | None, model: NarxModel) -> Array | None:
    """Return the noise ratio, shape () or (terms,), where one is given."""
    if given is None:
        return None
    ratio = store.real_numbers(given, "noise_ratio")
    if ratio.shape not in ((), (len(model.terms),)):
        raise InputError(
            f"its shape is {ratio.shape}",
            field="noise_ratio",
            remedy=f"Give one number, or one for each of the {len(model.terms)} terms: "
            + ", ".join(map(str, model.terms)),
        )
    if not np.all(np.isfinite(ratio) & (ratio >= 0.0)):
        raise InputError(
            f"it is {ratio}", field="noise_ratio", remedy="Give finite numbers, zero or more"
        )
    return ratio


def _undetermined(model: NarxModel, signals: NormalisedSignals) -> str:
    """Return why estimates of the whole record do not hold at its parts, empty where they do."""
    curved = curvature_of_windows(model, signals.u, signals.measured)
    return UNDETERMINED if curved > LARGEST_CURVATURE else ""


def _equations(model: NarxModel, signals: NormalisedSignals) -> tuple[Array, Array]:
    """Return regressors and outputs after the largest lag.

    The output is NaN where it, or one that a regressor holds, is missing.
    """
    lag = model.max_lag
    known = signals.seen.copy()
    for past in {past for term in model.terms for past in term.y_lags}:
        known[past:] &= signals.seen[:-past]
    target = np.where(known, signals.y, np.nan)[lag:]
    if not np.isfinite(target).any():
        raise InputError(
            "a missing sample enters every equation",
            field="y",
            remedy="Record it again, or take a model of smaller lags",
        )
    return regressor_matrix(model.terms, signals.u, signals.y), target


def _local(
    model: NarxModel,
    signals: NormalisedSignals,
    at: NDArray[np.int64],
    method: str,
    settings: dict[str, Any],
) -> TrackerEstimate:
    """Track by estimates of windows."""
    Phi, target = _equations(model, signals)
    estimates = local_estimates(model, signals.u, signals.measured, settings["window"])
    samples = np.arange(model.max_lag, signals.y.size, dtype=float)
    theta, covariance = estimates.parameters(samples), estimates.at(samples[at])[1]
    deviation = np.sqrt(np.maximum(np.einsum("kii->ki", covariance), 0.0))
    std = np.stack([np.interp(samples, samples[at], each) for each in deviation.T], axis=1)
    innovation = target - np.sum(Phi * theta, axis=1)
    withheld = WINDOWS_FAILED.format(estimates.failed) if estimates.failed else ""
    if not withheld and estimates.separate < SEPARATE:
        usual, taken = usual_window(model, signals.y.size), settings["window"]
        remedy = f"take a window of {usual} samples" if usual < taken else "take a longer record"
        withheld = WINDOWS_FEW.format(floor(10 * estimates.separate) / 10, SEPARATE, remedy)
    if estimates.curvature > LARGEST_CURVATURE:
        withheld = withheld or UNDETERMINED
    return TrackerEstimate(theta, std, innovation, covariance, method, withheld)


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
    if "delta" in chosen:
        check_delta(chosen["delta"])
    for name in ("thinning", "instants", "window"):
        if chosen.get(name) is not None:
            check_count(name, chosen[name])
            chosen[name] = int(chosen[name])
    return chosen


def _bounded(model: NarxModel, starts: list[Smoothed], u: Array, y: Array) -> int:
    """Return which of ``starts`` has the smallest free-run error."""
    errors = [free_run(model, start.theta, u, y)[1] for start in starts]
    best = int(np.argmin(errors))
    if not np.isfinite(errors[best]):
        raise InputError(
            "the free run diverges with the model's own parameters and with tracked ones",
            field="model",
            remedy="Take a model that is stable on this record, or another method",
        )
    return best
