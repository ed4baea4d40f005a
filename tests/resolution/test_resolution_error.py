"""The error of an explanation, against its covariance written out."""

import numpy as np
import pytest

from dea.resolution.error import Error
from dea.resolution.law_error import LawError, Motion

N = 400


def coloured(memory, n=N):
    """Correlations of an autoregression whose autocorrelation sums to the memory."""
    pole = (memory - 1.0) / (memory + 1.0)
    return pole ** np.abs(np.subtract.outer(np.arange(n), np.arange(n)))


def covariance(error):
    """White noise, and autoregressions of the same variance."""
    parts = [coloured(memory) for memory in error.memories]
    return error.white**2 * np.eye(N) + error.coloured**2 * np.mean(parts, axis=0)


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
    assert error.log_determinant(np.ones(N, bool)) == pytest.approx(
        np.linalg.slogdet(S)[1], abs=0.02 * N
    )


def test_the_coloured_error_has_parts_from_the_fastest_to_the_slowest():
    memories = Error(0.1, 0.2, 1000.0, 10.0).memories
    assert (memories[0], memories[-1]) == pytest.approx((10.0, 1000.0))
    assert np.ptp(np.diff(np.log(memories))) == pytest.approx(0.0, abs=1e-12)
    assert memories[1] <= 30.0
    np.testing.assert_array_equal(Error(0.1, 0.2, 1.0).memories, [1.0])


@pytest.mark.parametrize("memory", [10.0, 30.0, 150.0, 1000.0])
def test_a_law_that_errs_on_a_scale_of_its_own_is_not_thought_much_less_likely(memory):
    """Its error is of the size that is expected, and slower parts would have been possible."""
    n, error = 1500, Error(0.5, 0.5, 1000.0, 10.0)
    S = error.white**2 * np.eye(n) + error.coloured**2 * coloured(memory, n)
    y = np.linalg.cholesky(S) @ np.random.default_rng(4).standard_normal((n, 20))
    own = np.sum(y * np.linalg.solve(S, y), axis=0).mean() + np.linalg.slogdet(S)[1]
    told = np.sum(error.whitened(y) ** 2, axis=0).mean() + error.log_determinant(np.ones(n, bool))
    assert 0.5 * (told - own) < 60.0


@pytest.mark.parametrize("error", [Error(0.5, 0.4, 9.0), Error(0.3, 1.0, 30.0, 3.0)])
def test_what_the_error_does_to_signals_is_what_its_covariance_does(error):
    X = np.cumsum(np.random.default_rng(5).standard_normal((N, 3)), axis=0)
    X *= np.hanning(N)[:, None]
    found, exact = error.spread(X), X.T @ covariance(error) @ X
    norms = np.sqrt(np.diag(exact))
    np.testing.assert_allclose(found.T @ found, exact, atol=0.02 * np.outer(norms, norms).max())


@pytest.mark.parametrize("factor", [2, 5])
def test_a_decimated_record_tells_the_error_and_the_motion_of_a_whole_one(factor):
    """Correlations and steps over the same time, in samples of either."""
    coarse, n = Error(0.2, 0.4, 60.0, 12.0), 600
    fine = coarse.at_rate(factor)
    assert (fine.white, fine.coloured) == (0.2, 0.4)
    for few, many in zip(coarse.memories, fine.memories, strict=True):
        expected = coloured(few, n // factor)
        np.testing.assert_allclose(coloured(many, n)[::factor, ::factor], expected, atol=3e-3)
    y = np.cumsum(np.cumsum(np.random.default_rng(6).standard_normal(20_000)))
    whole, decimated = Motion.of(y, apart=factor), Motion.of(y[::factor])
    assert whole == pytest.approx(decimated, rel=0.01)
    error = LawError(fine, decimated, 0.0, apart=factor)
    assert error.on([y], [1.0], y).right.coloured == pytest.approx(0.4, rel=0.01)


def test_white_noise_alone_is_scaled_alone():
    signal = np.random.default_rng(1).standard_normal((N, 2))
    whitened = Error(0.5, 0.0, 1.0).whitened(signal)
    np.testing.assert_allclose(np.sum(whitened**2, 0), np.sum(signal**2, 0) / 0.25, rtol=1e-12)
    np.testing.assert_array_equal(Error(0.5, 0.0, 1.0).whitened(signal[:, 0]), whitened[:, 0])


def test_the_error_grows_with_the_motion_and_with_what_the_effects_do():
    y = np.random.default_rng(2).standard_normal(N)
    error = LawError(Error(0.1, 0.2, 9.0), Motion.of(y), 0.05)
    assert error.on([0.5 * y], [1.0], 0.5 * y).right == error.seen
    assert error.on([3.0 * y], [1.0], 3.0 * y).right.coloured == pytest.approx(0.6)
    slow = np.repeat(y, 2)[:N]
    faster = LawError(error.seen, Motion.of(slow), 0.05).on([y], [1.0], y).right
    assert faster.coloured == pytest.approx(0.2 * Motion.of(y).pace / Motion.of(slow).pace)
    moved = error.on([y, y + 40.0], [0.75, 0.25], y).right
    assert moved.coloured == pytest.approx(0.05 * 20.0)
    away = np.full(N, np.nan)
    assert error.on([y, away], [0.5, 0.5], y).right == error.seen
    assert error.on([away], [1.0], y).right == error.seen
    assert error.on([3.0 * y], [1.0], away).right.coloured == pytest.approx(0.6)


def test_another_explanation_errs_by_up_to_what_is_unexplained_grown_alike():
    """It begins where a right explanation ends, and is twice as far from it at least."""
    y = np.random.default_rng(3).standard_normal(N)
    error = LawError(Error(0.1, 0.05, 9.0), Motion.of(y), 0.05, unexplained=0.8, allowed=0.25)

    def levels(*given):
        return [each.coloured for each in error.on(*given).another]

    assert levels([y], [1.0], y) == pytest.approx([0.2, 0.4, 0.8])
    assert levels([3.0 * y], [1.0], 3.0 * y) == pytest.approx([0.6, 1.2, 2.4])
    assert levels([y], [1.0], y + 6.0) == pytest.approx([0.6, 0.8])
    assert levels([y], [1.0], y + 40.0) == pytest.approx([4.0])
    assert levels([y], [1.0], np.full(N, np.nan)) == pytest.approx([0.2, 0.4, 0.8])
    right = LawError(Error(0.1, 0.0, 9.0), Motion.of(y), 0.0).on([y], [1.0], y)
    assert right.another == (right.right,)


@pytest.mark.slow
@pytest.mark.parametrize(
    "error", [Error(0.3, 1.0, 40.0), Error(0.5, 0.8, 200.0, 5.0), Error(1.0, 0.0, 1.0)]
)
def test_of_missing_samples_neither_energy_nor_determinant_is_counted(error):
    """Against the rows and columns of the dense covariance that belong to known samples."""
    rng = np.random.default_rng(8)
    known = rng.random(N) < 0.6
    S = covariance(error)[np.ix_(known, known)]
    signals = rng.standard_normal((N, 2))
    whitened = error.whitened(signals, known)
    expected = np.linalg.solve(S, signals[known])
    np.testing.assert_allclose(whitened.T @ whitened, signals[known].T @ expected, rtol=1e-9)
    assert error.log_determinant(known) == pytest.approx(np.linalg.slogdet(S)[1], abs=1e-8)
    np.testing.assert_array_equal(error.whitened(signals[:, 0], known), whitened[:, 0])
