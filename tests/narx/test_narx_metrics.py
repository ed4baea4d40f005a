import warnings

import numpy as np
import pytest

from dea.errors import InputError
from dea.narx.metrics import fit, fpe, nmse, rmse

Y = np.array([1.0, 2.0, 3.0, 4.0])
RUN = np.array([1.0, 2.0, 3.0, 6.0])


def test_metrics_by_hand():
    assert nmse(Y, RUN) == pytest.approx(4 / 5)
    assert fit(Y, RUN) == pytest.approx(1 / 5)
    assert rmse(Y, RUN) == pytest.approx(1.0)
    assert fpe(Y, RUN, 2) == pytest.approx(1.0 * 1.5 / 0.5)  # (33)


def test_a_diverged_run_has_an_infinite_error_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = np.array([1.0, 2.0, np.inf, np.inf])
        assert nmse(Y, run) == rmse(Y, run) == fpe(Y, run, 2) == np.inf
        assert fit(Y, run) == -np.inf
        assert fpe(Y, RUN, 4) == np.inf


def test_errors_of_no_sample_are_refused():
    for score in (nmse, fit, rmse, lambda y, run: fpe(y, run, 1)):
        with pytest.raises(InputError, match="measured: there is no sample"):
            score([], [])
