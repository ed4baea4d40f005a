"""The error of an explanation, against its covariance written out."""

import numpy as np
import pytest

from dea.resolution.error import Error

N = 400


def covariance(error):
    """White noise and an autoregression, whose autocorrelation sums to the memory."""
    pole = (error.memory - 1.0) / (error.memory + 1.0)
    apart = np.abs(np.subtract.outer(np.arange(N), np.arange(N)))
    return error.white**2 * np.eye(N) + error.coloured**2 * pole**apart


@pytest.mark.parametrize(
    "error", [Error(0.5, 0.0, 9.0), Error(0.5, 0.4, 9.0), Error(0.3, 1.0, 30.0)]
)
def test_whitened_energy_and_determinant_are_those_of_the_covariance(error):
    S = covariance(error)
    root = np.linalg.cholesky(S)
    drawn = root @ np.random.default_rng(0).standard_normal((N, 300))
    energy = np.sum(error.whitened(drawn) ** 2, axis=0)
    assert energy.mean() == pytest.approx(N, rel=0.03)
    exact = np.sum(drawn * np.linalg.solve(S, drawn), axis=0)
    assert np.corrcoef(energy, exact)[0, 1] > 0.97
    assert error.log_determinant(N) == pytest.approx(np.linalg.slogdet(S)[1], abs=0.02 * N)


def test_white_noise_alone_is_scaled_alone():
    signal = np.random.default_rng(1).standard_normal((N, 2))
    whitened = Error(0.5, 0.0, 1.0).whitened(signal)
    np.testing.assert_allclose(np.sum(whitened**2, 0), np.sum(signal**2, 0) / 0.25, rtol=1e-12)
    np.testing.assert_array_equal(Error(0.5, 0.0, 1.0).whitened(signal[:, 0]), whitened[:, 0])
