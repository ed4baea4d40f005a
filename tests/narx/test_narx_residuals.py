import numpy as np
import pytest
from scipy.signal import lfilter

from dea.errors import InputError
from dea.narx.residuals import TESTS, band, correlation_tests, each_test


def coloured(rng, samples):
    """An input as smooth as the study's: most of its power below a fiftieth of the sampling."""
    return lfilter([0.1], [1.0, -0.9], rng.standard_normal(samples + 100))[100:]


def test_coefficients_by_their_definition():
    rng = np.random.default_rng(0)
    e, u = rng.standard_normal(50), rng.standard_normal(50)
    found = dict(zip(TESTS, correlation_tests(e, u, 4), strict=True))
    e, u = e - e.mean(), u - u.mean()
    square = u**2 - np.mean(u**2)
    pairs = {
        "phi_ee": (e, e),
        "phi_eu": (e, u),
        "phi_e(eu)": (e, e * u - np.mean(e * u)),
        "phi_u2e": (e, square),
        "phi_u2e2": (e**2 - np.mean(e**2), square),
    }
    for name, (a, b) in pairs.items():
        for lag in (1, 4):
            products = [a[t] * b[t - lag] for t in range(lag, 50)]
            mean = np.mean(products) / np.sqrt(np.mean(a**2) * np.mean(b**2))
            assert found[name][lag - 1] == pytest.approx(mean * np.sqrt((50 - lag) / 50))


@pytest.mark.parametrize("white_input", [True, False])
def test_the_band_holds_95_percent_on_white_residuals_at_every_lag(white_input):
    samples, max_lag, records = 600, 60, 500
    rng = np.random.default_rng(1)
    outside = np.zeros((len(TESTS), max_lag))
    for _ in range(records):
        u = rng.standard_normal(samples) if white_input else coloured(rng, samples)
        e = rng.standard_normal(samples)
        outside += np.abs(correlation_tests(e, u, max_lag)) > band(samples)
    share = outside / records
    np.testing.assert_allclose(share.mean(axis=1), 0.05, atol=0.012)
    # One lag's share has a standard deviation of 0.01; a wrong weight of late lags shows here.
    np.testing.assert_allclose(share[:, 40:].mean(axis=1), 0.05, atol=0.02)
    np.testing.assert_allclose(share[:, :20].mean(axis=1), 0.05, atol=0.02)


@pytest.mark.parametrize(
    ("caught_by", "missed"),
    [
        ("phi_ee", lambda e, u: e + 0.5 * np.roll(e, 3)),
        ("phi_eu", lambda e, u: e + 0.5 * np.roll(u, 3)),
        ("phi_u2e", lambda e, u: e + 0.5 * np.roll(u, 3) ** 2),
        ("phi_e(eu)", lambda e, u: e + 0.7 * np.roll(e * u, 3)),
        ("phi_u2e2", lambda e, u: e * (1 + 0.7 * np.roll(u, 3) ** 2)),
    ],
)
def test_each_test_sees_what_it_is_for(caught_by, missed):
    rng = np.random.default_rng(2)
    e, u = rng.standard_normal(3000), rng.standard_normal(3000)
    found = dict(zip(TESTS, correlation_tests(missed(e, u), u, 10), strict=True))
    assert np.abs(found[caught_by][2]) > 4 * band(3000)


def test_a_diverged_or_perfect_run_leaves_no_nan():
    u = np.sin(np.arange(100.0))
    assert np.isposinf(correlation_tests(np.full(100, -np.inf), u, 5)).all()
    assert np.all(correlation_tests(np.zeros(100), u, 5) == 0.0)


def test_several_inputs_are_tested_one_by_one():
    rng = np.random.default_rng(4)
    e, u = rng.standard_normal(300), rng.standard_normal((300, 2))
    names = list(each_test(2))
    assert names[0] == "phi_ee"
    assert names[1:9:4] == ["phi_eu, u1", "phi_eu, u2"]
    assert names[9:] == ["phi_uue, u1u2"]
    found = correlation_tests(e, u, 6)
    each = [correlation_tests(e, u[:, k], 6) for k in (0, 1)]
    np.testing.assert_allclose(found[:9], np.concatenate([each[0], each[1][1:]]), atol=1e-15)


def test_the_product_of_two_inputs_has_a_test_of_its_own():
    rng = np.random.default_rng(4)
    u = rng.standard_normal((2000, 2))
    e = rng.standard_normal(2000) + 0.5 * np.roll(u[:, 0] * u[:, 1], 3)
    both = (u - u.mean(axis=0)).prod(axis=1)
    found = dict(zip(each_test(2), correlation_tests(e, u, 5), strict=True))["phi_uue, u1u2"]
    lagged = np.corrcoef(e[3:], both[:-3])[0, 1]
    assert found[2] == pytest.approx(lagged, rel=0.01)
    assert found[2] > 5 * band(2000)
    assert np.abs(found[[0, 1, 3, 4]]).max() < 2 * band(2000)


@pytest.mark.parametrize("max_lag", [0, 10, 2.5, "3"])
def test_a_lag_that_no_two_samples_are_apart_by_is_refused(max_lag):
    e = np.random.default_rng(0).standard_normal(10)
    with pytest.raises(InputError, match=f"max_lag: it is {max_lag!r} for 10 samples"):
        correlation_tests(e, e, max_lag)
