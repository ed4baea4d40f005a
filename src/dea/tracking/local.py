"""Tracking by local output-error estimates: the model refined on windows of the record.

In each of many overlapping windows the parameters are constant and minimise the error of a free
run, as in the refinement of a model (local likelihood: R. Tibshirani and T. Hastie, JASA 82, 1987;
J. Fan and I. Gijbels, Local Polynomial Modelling, 1996). The outputs that the run starts from and a
level that creeps through the window, a parabola in time, are unknowns of each window. What changes
in proportion to time within a window cancels at its centre, to which the estimate belongs; between
centres estimates are interpolated.
"""

from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from dea.arrays import Array, Indices
from dea.errors import InputError
from dea.missing import runs
from dea.narx import FreeRunFit, NarxModel, curvature, fit_free_runs
from dea.tracking.scatter import widened

_OVERLAP = 8  # windows that hold a sample
_PER_UNKNOWN = 2  # samples of a stretch, at least
_TREND = 2  # degree of the level within a window
_STARTS = 4  # estimates of other windows that one may begin from
_LONGEST = 4000  # samples of a window
_QUARTERS = 4  # windows of a record, at least, whose curvature is judged
SEPARATE = 8  # windows that do not overlap, which tell how estimates scatter
_ITERATIONS = 10
_TOLERANCE = 1e-6  # of the squared error: a small part of a standard deviation


class WindowEstimates(NamedTuple):
    """Estimates of windows of ``length`` samples in the order of their centres."""

    centre: Array  # (windows,) in samples
    theta: Array  # (windows, p)
    covariance: Array  # (windows, p, p)
    length: int
    failed: int  # windows without an estimate, which are left out
    curvature: float  # median over windows that do not overlap

    @property
    def separate(self) -> float:
        """How many windows that do not overlap the estimates span."""
        return float((self.centre[-1] - self.centre[0]) / self.length + 1.0)

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return parameters (k, p) and covariances (k, p, p) at the samples ``t``, (k,)."""
        first, second, weight, shared = self._neighbours(t)
        covariance = np.empty((t.size, *self.covariance.shape[1:]))
        for k, (i, j, w, rho) in enumerate(zip(first, second, weight, shared, strict=True)):
            both = w * (1.0 - w) * rho
            covariance[k] = ((1.0 - w) ** 2 + both) * self.covariance[i]
            covariance[k] += (w**2 + both) * self.covariance[j]
        return self._between(first, second, weight), covariance

    def parameters(self, t: Array) -> Array:
        """Return parameters (k, p) at the samples ``t``, (k,)."""
        first, second, weight, _ = self._neighbours(t)
        return self._between(first, second, weight)

    def _between(self, first: Indices, second: Indices, weight: Array) -> Array:
        found: Array = self.theta[first] * (1.0 - weight)[:, None]
        found += self.theta[second] * weight[:, None]
        return found

    def _neighbours(self, t: Array) -> tuple[Indices, Indices, Array, Array]:
        """Return which two estimates each sample lies between, the weight of the second, and the
        share of the samples that the two have in common.

        Beyond the first and the last centre, the line through that estimate and the nearest one
        whose window does not overlap is continued.
        """
        last = self.centre.size - 1
        second = np.clip(np.searchsorted(self.centre, t), min(1, last), last)
        first = np.maximum(second - 1, 0)
        apart = np.minimum(np.searchsorted(self.centre, self.centre[0] + self.length), last)
        before = t < self.centre[0]
        first[before], second[before] = 0, apart
        apart = np.searchsorted(self.centre, self.centre[-1] - self.length, side="right") - 1
        after = t > self.centre[-1]
        first[after], second[after] = max(int(apart), 0), last
        distance = self.centre[second] - self.centre[first]
        weight = np.where(distance > 0.0, t - self.centre[first], 0.0) / np.maximum(distance, 1.0)
        return first, second, weight, np.maximum(1.0 - distance / self.length, 0.0)


def usual_window(model: NarxModel, samples: int) -> int:
    """Return how many samples of a record a window has unless it is told: an eighth, or 4000.

    No fewer than its unknowns need.
    """
    return max(min(_LONGEST, samples // SEPARATE), _least(model))


def local_estimates(model: NarxModel, u: Array, y: Array, length: int) -> WindowEstimates:
    """Return the estimates of windows of ``length`` samples of a normalised record.

    Outputs that are missing are NaN; a window has a run for each stretch between them. A shorter
    record is one window, whose parameters are constant.

    Each begins from the estimate of the window before; where the run diverges, from those of
    windows farther back, of windows after it, or from the model's own parameters. The covariance is
    that of the noise of each window, wider in the directions in which estimates of separate windows
    scatter more than it explains.

    Raises
    ------
    InputError
        If a window is too short for the unknowns, or no window has an estimate.
    """
    windows = _Windowed(model, u, y, min(length, y.size), _OVERLAP)
    if windows.length < windows.least:
        raise InputError(
            f"{windows.length} samples tell too little of {len(model.terms)} parameters",
            field="window",
            remedy=f"Give at least {windows.least}, and a record as long",
        )
    length, fits = windows.length, windows.fits()
    kept = np.array([fit is not None for fit in fits])
    if not kept.any():
        raise InputError(
            "its free run diverges in every window of the record",
            field="model",
            remedy="Take a model that is stable on this record, or another method",
        )
    chosen = [fit for fit in fits if fit is not None]
    theta = np.stack([fit.parameters for fit in chosen])
    covariance = np.stack([fit.covariance for fit in chosen])
    centre = windows.starts[kept] + (length - 1) / 2.0
    covariance = widened(centre, theta, covariance, length)
    failed = int(np.sum(~kept))
    return WindowEstimates(centre, theta, covariance, length, failed, windows.curvature(fits))


def curvature_of_windows(model: NarxModel, u: Array, y: Array) -> float:
    """Return the median curvature of estimates of separate windows of a normalised record.

    The windows are as long as those of the local estimates, but no longer than a quarter of the
    record. Infinite where most have no estimate, or the record is too short for one.
    """
    windows = _Windowed(model, u, y, min(_LONGEST, y.size // _QUARTERS), 1)
    return windows.curvature(windows.fits()) if windows.length >= windows.least else np.inf


class _Windowed:
    """A record cut into windows."""

    def __init__(self, model: NarxModel, u: Array, y: Array, length: int, overlap: int) -> None:
        self._model, self._overlap, self.length = model, overlap, length
        self.least = _least(model)
        count = 1 + -(-(y.size - length) * overlap // max(length, 1))
        self.starts = np.linspace(0, y.size - length, count).astype(np.int64)
        self._windows = [
            _stretches(u[a : a + length], y[a : a + length], self.least) for a in self.starts
        ]

    def fits(self) -> list[FreeRunFit | None]:
        """Return the estimate of each window, begun from those of others; None without one."""
        fits: list[FreeRunFit | None] = [None] * len(self._windows)
        for order in (range(len(fits)), range(len(fits) - 1, -1, -1)):
            latest: deque[Array] = deque(maxlen=_STARTS)
            for k in order:
                if fits[k] is None:
                    starts = (*latest, self._model.parameters)
                    fits[k] = _fitted(self._model, starts, self._windows[k])
                if (fit := fits[k]) is not None:
                    latest.appendleft(fit.parameters)
        return fits

    def curvature(self, fits: list[FreeRunFit | None]) -> float:
        """Return the median over windows that do not overlap."""
        chosen = fits[:: self._overlap]
        return float(np.median([np.inf if fit is None else curvature(fit) for fit in chosen]))


def _least(model: NarxModel) -> int:
    return _PER_UNKNOWN * (len(model.terms) + model.max_lag + _TREND)


def _stretches(u: Array, y: Array, least: int) -> list[tuple[Array, Array]]:
    """Return the stretches without a missing output that have ``least`` samples."""
    return [(u[run], y[run]) for run in runs(~np.isnan(y)) if run.stop - run.start >= least]


def _fitted(
    model: NarxModel, starts: Iterable[Array], segments: list[tuple[Array, Array]]
) -> FreeRunFit | None:
    """Return the estimate from the first start whose run stays bounded, None where none does."""
    for start in starts if segments else ():
        fit = fit_free_runs(model.terms, start, segments, _ITERATIONS, _TOLERANCE, _TREND)
        if np.isfinite(fit.msse) and np.isfinite(fit.covariance).all():
            return fit
    return None
