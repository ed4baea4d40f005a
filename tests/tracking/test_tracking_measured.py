"""Tracking a measured system that does not change: the Silverbox circuit."""

import numpy as np

from dea.narx import select_terms
from dea.tracking import METHODS, compare_free_runs, track_parameters
from measured_records import DATA, needs_records

RECORD = DATA / "silverbox" / "SNLS80mV.csv"
RATE = 610.35


@needs_records
def test_noise_on_measured_outputs_biases_all_but_the_output_error_smoother():
    u, y = np.loadtxt(RECORD, delimiter=",", skiprows=1, usecols=(0, 1))[80_000:100_000].T
    model = select_terms(u[:5000], y[:5000], y_lags=3, u_lags=3, degree=3)
    tracks = {
        method: track_parameters(model, u, y, method=method, sampling_rate=RATE)
        for method in METHODS
    }
    rmse = compare_free_runs(model, tracks, u, y, window=1000)["rmse"].to_series()
    assert rmse["output_error"] < rmse["fixed"] < 0.001
    assert min(rmse["rls"], rmse["kalman"]) > 2.0 * rmse["output_error"]
    linear = tracks["output_error"]["parameter"].sel(term="y(t-1)")
    assert float(linear.std() / abs(linear.mean())) < 0.01
