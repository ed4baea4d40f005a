"""Parameters that change with time: recursive least squares and Kalman smoothing."""

from dea.tracking.free_runs import compare_free_runs, normalised_signals
from dea.tracking.kalman import Prior, fit_noise_ratio, log_likelihood, smooth
from dea.tracking.random_walk import root_mean_square
from dea.tracking.rls import RlsState, initial_state, recursive_least_squares, update
from dea.tracking.setting_checks import check_settings
from dea.tracking.structure import with_constant
from dea.tracking.track import METHODS, track_parameters

__all__ = [
    "METHODS",
    "Prior",
    "RlsState",
    "check_settings",
    "compare_free_runs",
    "fit_noise_ratio",
    "initial_state",
    "log_likelihood",
    "normalised_signals",
    "recursive_least_squares",
    "root_mean_square",
    "smooth",
    "track_parameters",
    "update",
    "with_constant",
]
