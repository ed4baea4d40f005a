"""Parameters that change with time: recursive least squares and Kalman smoothing."""

from dea.tracking.kalman import fit_noise_ratio, log_likelihood, smooth
from dea.tracking.rls import recursive_least_squares
from dea.tracking.structure import with_constant
from dea.tracking.success import compare_free_runs
from dea.tracking.track import METHODS, track_parameters

__all__ = [
    "METHODS",
    "compare_free_runs",
    "fit_noise_ratio",
    "log_likelihood",
    "recursive_least_squares",
    "smooth",
    "track_parameters",
    "with_constant",
]
