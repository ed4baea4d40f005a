"""Polynomial NARX models: terms, simulation, estimation, selection, validation."""

from dea.confidence import LEVEL
from dea.narx.baselines import baselines, constant
from dea.narx.candidate_terms import candidate_terms, linear_terms
from dea.narx.checks import as_input, as_signal, check_shape, check_variation
from dea.narx.common import compare_structures
from dea.narx.estimation import NOT_WHITE, estimate, not_white, scaling_of
from dea.narx.forecast import ForecastPlan, forecast_errors
from dea.narx.free_run_fit import FreeRunFit, curvature, fit_free_runs
from dea.narx.held_out import held_out_error
from dea.narx.inclusion import inclusion_frequency
from dea.narx.intervals import (
    Interval,
    covariance_of,
    parameter_interval,
    quantile,
    simulation_interval,
)
from dea.narx.kernels import NONE
from dea.narx.labels import Labels, check_rate, input_of, pair, rate_of
from dea.narx.lags import Compared, LagChoice, lag_choices, select_lags
from dea.narx.metrics import fit, fpe, nmse, rmse
from dea.narx.model import NarxModel
from dea.narx.orders import compare_orders, linear_model
from dea.narx.parameter_covariance import FreeRun, feedback_slope, noise_model, remove_feedback
from dea.narx.published import load_published
from dea.narx.refinement import estimate_refined, refine
from dea.narx.regressors import regressor_matrix
from dea.narx.residuals import correlation_tests
from dea.narx.rest import largest_pole, real_roots
from dea.narx.scaling import Scaling
from dea.narx.search import SEARCHES, Forward, Orthogonal, Refined, Search
from dea.narx.selection import select_common_terms, select_terms
from dea.narx.simulation import BOUND, padded_lags, simulate, simulate_varying
from dea.narx.stability import Stability, UnstableModel
from dea.narx.validation import Windows, validate

__all__ = [
    "BOUND",
    "LEVEL",
    "NONE",
    "NOT_WHITE",
    "SEARCHES",
    "Compared",
    "ForecastPlan",
    "Forward",
    "FreeRun",
    "FreeRunFit",
    "Interval",
    "Labels",
    "LagChoice",
    "NarxModel",
    "Orthogonal",
    "Refined",
    "Scaling",
    "Search",
    "Stability",
    "UnstableModel",
    "Windows",
    "as_input",
    "as_signal",
    "baselines",
    "candidate_terms",
    "check_rate",
    "check_shape",
    "check_variation",
    "compare_orders",
    "compare_structures",
    "constant",
    "correlation_tests",
    "covariance_of",
    "curvature",
    "estimate",
    "estimate_refined",
    "feedback_slope",
    "fit",
    "fit_free_runs",
    "forecast_errors",
    "fpe",
    "held_out_error",
    "inclusion_frequency",
    "input_of",
    "lag_choices",
    "largest_pole",
    "linear_model",
    "linear_terms",
    "load_published",
    "nmse",
    "noise_model",
    "not_white",
    "padded_lags",
    "pair",
    "parameter_interval",
    "quantile",
    "rate_of",
    "real_roots",
    "refine",
    "regressor_matrix",
    "remove_feedback",
    "rmse",
    "scaling_of",
    "select_common_terms",
    "select_lags",
    "select_terms",
    "simulate",
    "simulate_varying",
    "simulation_interval",
    "validate",
]
