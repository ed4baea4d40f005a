"""What freedom counts against an explanation: integrals, and all laws that a law stands for."""

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import logsumexp
from scipy.stats import cauchy

from dea.discrepancy.evidence.occam import log_volume


def fit_of(jacobian, coordinates, shapes=(), residual=None):
    """A fit that errs linearly in its coordinates, some of which only shape a law."""
    of_shape = np.isin(np.arange(jacobian.shape[1]), shapes)
    return SimpleNamespace(
        jacobian=jacobian, coordinates=np.asarray(coordinates, float),
        residual=np.zeros(len(jacobian)) if residual is None else residual,
        extended=SimpleNamespace(layout=SimpleNamespace(shapes=of_shape)),
    )  # fmt: skip


def fitted_to(y, X, deviation, shapes=()):
    """The fit of a linear law to readings with noise, and the log likelihood that it reaches."""
    k = X.shape[1]
    x = np.linalg.solve(X.T @ X + deviation**2 * np.eye(k), X.T @ y)
    reached = -0.5 * np.sum((y - X @ x) ** 2) / deviation**2
    return fit_of(-X, x, shapes, y - X @ x), reached


@pytest.mark.parametrize("true", [0.0, 0.8, 20.0])
@pytest.mark.parametrize("reach", [0.0, 1e-3, 5.0, 30.0])
def test_the_volume_left_makes_the_evidence_of_a_linear_law(true, reach):
    """The oracle integrates the likelihood over a Cauchy prior (scipy): told nothing, or much."""
    rng = np.random.default_rng(7)
    deviation, seen = 0.3, np.arange(80) < 60
    X = reach * rng.standard_normal((80, 1))
    y = X[:, 0] * true + deviation * rng.standard_normal(80)
    own = X[seen, 0]
    x = own @ y[seen] / (own @ own + deviation**2)

    def likelihood(value):
        return -0.5 * np.sum((y[seen] - own * value) ** 2) / deviation**2

    fitted = fit_of(-X, [x])
    found = likelihood(x) + log_volume(fitted, seen, deviation**2, 0.2)
    # Its peak may be narrow: integrated over the quantiles of the prior, in pieces about it.
    around = cauchy.cdf(x + np.array([-0.1, -0.01, 0.0, 0.01, 0.1]))
    exact, _ = quad(
        lambda rank: np.exp(likelihood(cauchy.ppf(rank)) - likelihood(x)),
        *(0.0, 1.0), points=around, limit=500,
    )  # fmt: skip
    # A direction that is told a little lies between the limits in which it is exact.
    assert found == pytest.approx(likelihood(x) + np.log(exact), abs=0.1)


def test_directions_that_a_record_tells_together_count_once():
    """Two columns that are one tell one combination, of twice its information."""
    X = np.random.default_rng(7).standard_normal((80, 1))
    seen = np.ones(80, bool)
    pair = fit_of(np.hstack([X, X]), np.zeros(2))
    single = fit_of(np.sqrt(2.0) * X, np.zeros(1))
    assert log_volume(pair, seen, 0.1, 0.2) == pytest.approx(log_volume(single, seen, 0.1, 0.2))


@pytest.mark.parametrize("told", [0.0, 1.0])
def test_a_shape_that_is_as_expected_hardly_counts_against_its_law(told):
    """Nothing where the record does not tell it; up to log 2 where it does."""
    rng = np.random.default_rng(8)
    X = rng.standard_normal((400, 4)) * [1.0, told, told, told]
    seen, deviation = np.ones(400, bool), 0.3
    y = X[:, 0] * 2.0 + deviation * rng.standard_normal(400)
    law, reached = fitted_to(y, X, deviation, shapes=(1, 2, 3))
    plain, reached_by_plain = fitted_to(y, X[:, :1], deviation)
    odds = log_volume(law, seen, deviation**2, 0.5) + reached
    odds -= log_volume(plain, seen, deviation**2, 0.5) + reached_by_plain
    if told:
        assert -3.0 * np.log(2.0) < odds < -3.0 * np.log(2.0) + 1.0
    else:
        assert odds == pytest.approx(0.0, abs=1e-9)


def test_a_shape_that_the_record_asks_for_counts_in_full():
    rng = np.random.default_rng(9)
    X = rng.standard_normal((400, 2))
    seen, variance = np.ones(400, bool), 0.09
    y = X @ [2.0, 1.5] + 0.3 * rng.standard_normal(400)
    law, _ = fitted_to(y, X, 0.3, shapes=(1,))
    free, _ = fitted_to(y, X, 0.3)
    difference = log_volume(law, seen, variance, 0.2) - log_volume(free, seen, variance, 0.2)
    assert difference == pytest.approx(np.log(0.2))


@pytest.mark.parametrize("shaped", [0.2, 0.5])
@pytest.mark.parametrize("larger", [1.0, 20.0])
@pytest.mark.parametrize("seed", range(6))
def test_the_evidence_is_that_of_all_laws_that_a_law_stands_for(seed, larger, shaped):
    """Each is fitted by itself, and counts in units of an error that is larger than the fit's."""
    rng = np.random.default_rng(seed)
    X = rng.standard_normal((300, 6)) @ (np.eye(6) + 0.4 * rng.standard_normal((6, 6)))
    true = np.where(rng.random(6) < 0.4, rng.normal(0.0, 0.3, 6), 0.0)
    seen, deviation = np.ones(300, bool), 1.0
    y = X @ true + rng.standard_normal(300)
    shapes = range(1, 6)
    law, reached = fitted_to(y, X, deviation, shapes)
    every = []
    for size in range(6):
        for used in combinations(shapes, size):
            some, likelihood = fitted_to(y, X[:, [0, *used]], deviation)
            volume = log_volume(some, seen, larger, shaped) + likelihood / larger
            every.append(volume + size * np.log(shaped) + (5 - size) * np.log1p(-shaped))
    found = log_volume(law, seen, larger, shaped) + reached / larger
    assert found == pytest.approx(logsumexp(every), abs=0.6)


def test_columns_that_are_one_in_a_record_without_noise_are_no_error():
    X = np.random.default_rng(3).standard_normal((400, 3))
    X[:, 1] = X[:, 0]
    found = log_volume(fit_of(-1e8 * X, np.ones(3), shapes=(2,)), np.ones(400, bool), 1e-3, 0.5)
    assert np.isfinite(found)
