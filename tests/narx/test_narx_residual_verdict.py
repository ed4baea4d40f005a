import numpy as np
import pytest
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter
from scipy.stats import chi2

from dea.narx.residual_verdict import joint_tests, verdict
from dea.narx.residuals import TESTS, band, each_test


def smooth(rng, samples, pole=0.95):
    return lfilter([1 - pole], [1.0, -pole], rng.standard_normal(samples + 300))[300:]


@pytest.mark.parametrize("colour", [0.0, 0.8, 0.97])
def test_each_test_refuses_five_percent_of_residuals_without_relation(colour):
    rng = np.random.default_rng(5)
    refused = np.zeros(len(TESTS))
    for _ in range(200):
        e = smooth(rng, 500, colour)
        refused += joint_tests(e, smooth(rng, 500), 25).p_value < 0.05
    # Ten of 200 on average, with a standard deviation of three.
    assert (refused[1:] < 22).all()
    assert refused[1:].sum() > 15
    assert (refused[0] < 20) == (colour == 0.0)


@pytest.mark.parametrize("lags", [1, 7, 25])
def test_whiteness_is_that_of_ljung_and_box(lags):
    rng = np.random.default_rng(8)
    e, u = smooth(rng, 300, 0.2), smooth(rng, 300)
    e -= e.mean()
    statistic = 0.0
    for k in range(1, lags + 1):
        rho = sum(e[t] * e[t - k] for t in range(k, e.size)) / sum(e * e)
        statistic += rho**2 / (e.size - k)
    statistic *= e.size * (e.size + 2)
    p = joint_tests(e, u, lags).p_value[0]
    assert p == pytest.approx(chi2.sf(statistic, lags), rel=1e-9)


@pytest.mark.parametrize(
    ("caught_by", "added"),
    [
        ("phi_ee", lambda e, u: 0.3 * np.roll(e, 3)),
        ("phi_eu", lambda e, u: 0.3 * np.roll(u, 3)),
        ("phi_e(eu)", lambda e, u: 0.3 * np.roll(e * u, 3)),
        ("phi_u2e", lambda e, u: 0.3 * np.roll(u, 3) ** 2),
        ("phi_u2e2", lambda e, u: e * np.abs(np.roll(u, 3))),
    ],
)
def test_each_test_sees_what_it_is_for(caught_by, added):
    rng = np.random.default_rng(2)
    e, u = rng.standard_normal(1500), 3 * smooth(rng, 1500)
    u /= u.std()
    found = joint_tests(e + added(e, u), u, 25)
    at = list(TESTS).index(caught_by)
    assert found.p_value[at] < 1e-4
    assert 0.01 < found.explained[at] < 0.6


def test_the_correlations_are_those_of_the_signals_that_are_tested():
    """Against sums over signals filtered as Yule and Walker's equations say, here of order one."""
    rng = np.random.default_rng(6)
    e, u = smooth(rng, 400, 0.9), smooth(rng, 400)
    e, u = e - e.mean(), u - u.mean()
    theta = e[1:] @ e[:-1] / (e @ e)
    white = e[1:] - theta * e[:-1]

    def filtered(signal):
        return signal[1:] - theta * signal[:-1]

    square = u**2 - np.mean(u**2)
    pairs = {
        "phi_ee": (e, e),
        "phi_eu": (white, filtered(u)),
        "phi_e(eu)": (white, filtered(e * u)),
        "phi_u2e": (white, filtered(square)),
        "phi_u2e2": (white**2, square[1:]),
    }
    found = dict(zip(TESTS, joint_tests(e, u, 9).correlation, strict=True))
    for test, (one, other) in pairs.items():
        a, b = one - one.mean(), other - other.mean()
        for lag in (1, 9):
            sums = sum(a[t] * b[t - lag] for t in range(lag, a.size))
            weight = np.sqrt(a.size / (a.size - lag) * a.size / 400)
            expected = weight * sums / np.sqrt(sum(a * a) * sum(b * b))
            assert found[test][lag - 1] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("colour", [0.0, 0.97])
def test_the_band_holds_95_percent_of_the_tested_correlations_of_any_residual(colour):
    rng = np.random.default_rng(9)
    outside = np.zeros((len(TESTS), 25))
    for _ in range(300):
        found = joint_tests(smooth(rng, 500, colour), smooth(rng, 500), 25)
        outside += np.abs(found.correlation) > band(500)
    share = outside[1:] / 300
    np.testing.assert_allclose(share.mean(axis=1), 0.05, atol=0.02)


def test_the_share_explained_is_that_of_the_input_in_the_residual():
    rng = np.random.default_rng(3)
    e, u = rng.standard_normal(20_000), rng.standard_normal(20_000)
    found = joint_tests(e + 0.5 * np.roll(u, 3), u, 10)
    assert found.explained[1] == pytest.approx(0.25 / 1.25, abs=0.02)
    assert found.explained[2:4].max() < 0.01


def test_units_and_their_zero_do_not_matter():
    rng = np.random.default_rng(4)
    e, u = smooth(rng, 500, 0.8), smooth(rng, 500)
    found, scaled = joint_tests(e, u, 25), joint_tests(1e-3 * e, 50.0 * u + 7.0, 25)
    np.testing.assert_allclose(scaled.p_value, found.p_value, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(scaled.explained, found.explained, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_a_residual_is_made_white_by_as_many_lags_as_schwarz_s_criterion_says(seed):
    """Against Yule and Walker's equations, solved for every number of lags."""
    e = 0.01 * smooth(np.random.default_rng(seed), 300, 0.25 * (seed % 2))
    e -= e.mean()
    products = np.correlate(e, e, "full")[299:] / 300
    costs, whites = [], []
    for order in range(16):  # of at least twenty samples for each
        theta = solve_toeplitz(products[:order], products[1 : order + 1]) if order else np.zeros(0)
        left = products[0] - theta @ products[1 : order + 1]
        costs.append(300 * np.log(left) + order * np.log(300))
        white = e[order:] - sum(theta[k] * e[order - 1 - k : 299 - k] for k in range(order))
        whites.append(1.0 - white.var() / e.var())
    explained = max(whites[int(np.argmin(costs))], 0.0)
    assert joint_tests(e, e, 10).explained[0] == pytest.approx(explained, rel=1e-6, abs=1e-12)


def test_residuals_that_are_constant_or_not_finite_have_an_answer():
    u = np.sin(np.arange(200.0))
    for residual, p in ((np.full(200, np.inf), 0.0), (np.zeros(200), 1.0)):
        found = joint_tests(residual, u, 10)
        assert found.p_value.tolist() == [p] * len(TESTS)
        assert (found.correlation == (0.0 if p else np.inf)).all()


def test_the_verdict_says_what_is_left():
    p, explained = np.full((3, 5), 0.5), np.zeros((3, 5))
    said = verdict(p, explained, 0.002, 0.1, "mm")
    assert said == (
        "The residual is 0.002 mm, 2 % of the output's spread; it is white, and past inputs explain"
        " nothing of it (p = 1)."
    )
    p[:, 0] = 0.0
    assert "it is coloured, and past inputs explain nothing" in verdict(p, explained, 1, 2, "mm")
    p[1, list(TESTS).index("phi_u2e")], explained[1, 3] = 1e-6, 0.2
    said = verdict(p, explained, 1.0, 2.0, "mm")
    assert "past values of the square of the input (20 %) still explain" in said
    assert "(p < 0.001)" in said
    # Fifteen tests of one system share one level.
    p = np.full((3, 5), 0.5)
    p[0, 1] = 0.01
    assert "explain nothing" in verdict(p, explained, 1.0, 2.0, "mm")
    assert "diverges" in verdict(p, explained, np.inf, 2.0, "mm")


@pytest.mark.parametrize(
    ("rms", "spread", "size"),
    [
        (0.0999, 0.1, "0.1 mm, 100 % of"),
        (123.0, 100.0, "120 mm, 120 % of"),
        (0.05, 2.0, "0.05 mm, 2.5 % of"),
        (2e-4, 2.0, "0.0002 mm, 0.01 % of"),
    ],
)
def test_sizes_and_shares_are_written_out(rms, spread, size):
    p, explained = np.full((1, 5), 0.5), np.zeros((1, 5))
    p[0, 1], explained[0, 1] = 1e-6, 0.996
    said = verdict(p, explained, rms, spread, "mm")
    assert f"The residual is {size} the output's spread" in said
    assert "past values of the input (100 %)" in said


def test_the_verdict_names_which_of_several_inputs_explains_the_residual():
    rng = np.random.default_rng(5)
    u = rng.standard_normal((600, 2))
    e = rng.standard_normal(600) + 0.5 * np.roll(u[:, 1], 3)
    found = joint_tests(e, u, 10)
    said = verdict(found.p_value[None], found.explained[None], 1.0, 2.0, "K", ["left", "right"])
    assert "past values of right (" in said
    assert "left" not in said


def test_a_missing_product_of_two_inputs_is_seen_and_named():
    rng = np.random.default_rng(7)
    u = np.column_stack([smooth(rng, 1500, 0.5) for _ in range(3)])
    u /= u.std(axis=0)
    e = rng.standard_normal(1500) + 0.4 * np.roll(u[:, 0] * u[:, 2], 1)
    found = joint_tests(e, u, 25)
    pair = list(each_test(3)).index("phi_uue, u1u3")
    assert found.p_value[pair] < 1e-4
    assert 0.05 < found.explained[pair] < 0.25
    said = verdict(found.p_value[None], found.explained[None], 1, 2, "K", ["left", "up", "right"])
    assert "the product of left and right (" in said
    assert "the product of left and up" not in said


def test_the_test_of_a_pair_refuses_five_percent_of_residuals_without_relation():
    rng = np.random.default_rng(8)
    refused = 0
    for _ in range(200):
        u = np.column_stack([smooth(rng, 500), smooth(rng, 500)])
        refused += joint_tests(smooth(rng, 500, 0.8), u, 25).p_value[-1] < 0.05
    assert 2 <= refused < 22  # ten on average, with a standard deviation of three
