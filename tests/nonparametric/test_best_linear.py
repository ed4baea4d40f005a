"""The best linear approximation against another computation, theory and repeated experiments."""

import numpy as np
import pytest

from dea.errors import InputError
from dea.nonparametric import Periods, best_linear

SAMPLES = 64
LINES = np.array([1, 3, 7, 9, 13])
AMPLITUDE = np.array([1.0, 0.8, 0.6, 0.9, 0.5])


def multisines(rng, realisations, periods=1):
    """Random-phase multisines, shape (realisations, periods, SAMPLES)."""
    spectrum = np.zeros((realisations, SAMPLES // 2 + 1), dtype=complex)
    phases = rng.uniform(0, 2 * np.pi, (realisations, LINES.size))
    spectrum[:, LINES] = 0.5 * SAMPLES * AMPLITUDE * np.exp(1j * phases)
    one = np.fft.irfft(spectrum, SAMPLES)
    return np.repeat(one[:, None], periods, axis=1)


def filtered(signal, response):
    """The periodic steady state of a linear system."""
    return np.fft.irfft(np.fft.rfft(signal) * response, SAMPLES)


def low_pass(pole):
    z = np.exp(2j * np.pi * np.arange(SAMPLES // 2 + 1) / SAMPLES)
    return (1 - pole) / (z - pole)


def by_sines_and_powers(u, y, order):
    """The response of one realisation by least squares on sines, cosines and powers of time."""
    flat_u, flat_y = u.ravel(), y.ravel()
    t = np.arange(flat_y.size)
    harmonics = np.arange(1, SAMPLES // 2)
    angle = 2 * np.pi * np.outer(t, harmonics) / SAMPLES
    basis = [np.ones(t.size), (-1.0) ** t, *np.cos(angle).T, *np.sin(angle).T]
    powers = [(t / t.size) ** k for k in range(1, order + 1)]
    coefficients = {}
    for name, signal, columns in (("u", flat_u, basis), ("y", flat_y, basis + powers)):
        found = np.linalg.lstsq(np.array(columns).T, signal, rcond=None)[0]
        cosines, sines = np.split(found[2 : 2 + 2 * harmonics.size], 2)
        coefficients[name] = (cosines - 1j * sines)[LINES - 1]
    return coefficients["y"] / coefficients["u"]


@pytest.mark.parametrize("order", [0, 1, 3])
def test_the_response_is_that_of_a_fit_of_sines_and_powers_of_time(order):
    rng = np.random.default_rng(order)
    u = multisines(rng, 3, 4)
    y = filtered(u, low_pass(0.7)) + 0.1 * rng.standard_normal(u.shape)
    y += np.linspace(0, 2, u[0].size).reshape(u[0].shape) ** 2
    found = best_linear(Periods(u, y, 0.0), order)
    np.testing.assert_array_equal(found.lines, LINES)
    each = [by_sines_and_powers(*pair, order) for pair in zip(u, y, strict=True)]
    np.testing.assert_allclose(found.response, np.mean(each, axis=0), rtol=1e-9)
    np.testing.assert_allclose(found.total, np.var(each, axis=0, ddof=1) / 3, rtol=1e-9)


def test_a_polynomial_drift_leaves_no_trace():
    rng = np.random.default_rng(4)
    u = multisines(rng, 2, 3)
    time = np.linspace(-1, 1, u[0].size).reshape(u[0].shape)
    still = best_linear(Periods(u, filtered(u, low_pass(0.5)), 0.0), 0)
    drifting = filtered(u, low_pass(0.5)) + 5 * time**3 - 2 * time + 1
    found = best_linear(Periods(u, drifting, 0.0), 3)
    np.testing.assert_allclose(found.response, still.response, rtol=1e-9)
    assert found.noise.max() < 1e-20


def test_the_best_linear_approximation_of_a_static_cubic():
    """Over random phases E G(k) = a + 3 c s^2 - 3/4 c A_k^2, with s the rms of the input."""
    rng = np.random.default_rng(5)
    a, c = 0.7, 0.4
    u = multisines(rng, 600, 2)
    found = best_linear(Periods(u, a * u + 0.5 * u**2 + c * u**3, 0.0), 0)
    expected = a + 3 * c * 0.5 * np.sum(AMPLITUDE**2) - 0.75 * c * AMPLITUDE**2
    assert (np.abs(found.response - expected) < 3 * np.sqrt(found.total)).all()
    assert (np.sqrt(found.total) < 0.03 * expected).all()
    assert found.noise.max() < 1e-20


def test_the_best_linear_approximation_of_a_wiener_hammerstein_system():
    """It is the product of both filters and the gain of the cubic for the signal between them."""
    rng = np.random.default_rng(6)
    before, after, c = low_pass(0.8), low_pass(0.3), 0.6
    u = multisines(rng, 600, 2)
    between = filtered(u, before)
    found = best_linear(Periods(u, filtered(between + c * between**3, after), 0.0), 0)
    amplitude = AMPLITUDE * np.abs(before[LINES])
    gain = 1 + 3 * c * 0.5 * np.sum(amplitude**2) - 0.75 * c * amplitude**2
    expected = gain * before[LINES] * after[LINES]
    assert (np.abs(found.response - expected) < 3 * np.sqrt(found.total)).all()
    assert (np.sqrt(found.total) < 0.03 * np.abs(expected)).all()


def test_even_distortion_answers_at_even_lines_and_odd_at_odd_ones():
    rng = np.random.default_rng(7)
    u = multisines(rng, 4, 2)
    for power, parity in ((2, 0), (3, 1)):
        found = best_linear(Periods(u, u + 0.3 * u**power, 0.0), 0)
        rest = found.detection
        level = np.abs(found.output[:, rest]).max(axis=0)
        assert level[rest % 2 == parity].max() > 0.05
        assert level[rest % 2 != parity].max() < 1e-12
        assert (found.distortion.max() > 1e-4) == (power == 3)


def test_noise_is_told_from_distortion_and_the_disc_holds_the_response():
    rng = np.random.default_rng(8)
    experiments, inside, noise, total = 400, 0, 0.0, 0.0
    true = low_pass(0.6)[LINES]
    for _ in range(experiments):
        u = multisines(rng, 4, 2)
        y = filtered(u, low_pass(0.6)) + 0.2 * rng.standard_normal(u.shape)
        found = best_linear(Periods(u, y, 0.0), 0)
        inside += np.mean(np.abs(found.response - true) <= found.radius()) / experiments
        noise += found.noise / experiments
        total += found.total / experiments
    # A coefficient of white noise of variance s^2 has s^2 / N; eight periods are averaged.
    expected = 0.2**2 / SAMPLES / 8 / (0.5 * AMPLITUDE) ** 2
    np.testing.assert_allclose(noise, expected, rtol=0.12)
    np.testing.assert_allclose(total, expected, rtol=0.15)
    assert inside == pytest.approx(0.95, abs=0.015)


def test_realisations_with_other_lines_are_refused():
    u = multisines(np.random.default_rng(9), 2, 2)
    u[1] += np.cos(2 * np.pi * 5 * np.arange(SAMPLES) / SAMPLES)
    with pytest.raises(InputError, match="different lines"):
        best_linear(Periods(u, u, 0.0))


def test_which_lines_are_excited_is_a_share_of_the_strongest_that_may_be_set():
    rng = np.random.default_rng(11)
    u = multisines(rng, 3, 2)
    u += 0.008 * np.cos(
        2 * np.pi * (5 * np.arange(SAMPLES) / SAMPLES + rng.uniform(size=(3, 1, 1)))
    )
    assert 5 in best_linear(Periods(u, 3.0 * u, 0.0)).detection
    found = best_linear(Periods(u, 3.0 * u, 0.0), excited_above=1e-3)
    assert sorted(found.lines) == sorted([5, *LINES])
    np.testing.assert_allclose(found.response, 3.0, rtol=1e-9)
    for share in (0.0, 1.0, np.nan, "0.1"):
        with pytest.raises(
            InputError, match=r"excited_above: it is .*Give a share between 0 and 1"
        ):
            best_linear(Periods(u, u, 0.0), excited_above=share)


@pytest.mark.parametrize("length", [SAMPLES // 2, SAMPLES + SAMPLES // 4])
def test_an_input_that_does_not_repeat_with_the_period_is_refused(length):
    """Half a period of an odd multisine is its negative: nothing is left to divide by."""
    u = multisines(np.random.default_rng(9), 3, 10)
    cut = u.reshape(3, -1)[:, : 8 * length].reshape(3, 8, length)
    with pytest.raises(InputError, match=r"period: the input of realisation 1 does not repeat"):
        best_linear(Periods(cut, cut, 0.0))


def test_the_first_realisation_that_does_not_repeat_is_told_with_its_own_part():
    u = multisines(np.random.default_rng(9), 3, 2)
    u[1, 1] *= -1.0  # nothing is common to its periods
    u[2, 1] *= 1.5
    with pytest.raises(InputError, match=r"realisation 2 .* between periods 100 % of its motion"):
        best_linear(Periods(u, u, 0.0))


def test_an_input_may_be_measured_with_noise():
    rng = np.random.default_rng(10)
    u = multisines(rng, 6, 4)
    measured = u + 2e-3 * u.std() * rng.standard_normal(u.shape)
    found = best_linear(Periods(measured, 2.0 * u, 0.0))
    np.testing.assert_allclose(np.abs(found.response), 2.0, rtol=5e-3)


@pytest.mark.parametrize(("periods", "order"), [(2, 3), (3, 2), (4, 0)])
def test_the_noise_is_the_scatter_of_repeated_experiments_at_every_line(periods, order):
    """Of a linear system, whose scatter between realisations is noise alone."""
    rng = np.random.default_rng(21)
    response, noise, total = [], [], []
    for _ in range(500):
        u = multisines(rng, 4, periods)
        y = filtered(u, low_pass(0.7)) + 0.1 * rng.standard_normal(u.shape)
        if order:
            y += np.linspace(0, 2, u[0].size).reshape(u[0].shape)
        found = best_linear(Periods(u, y, 0.0), order)
        response.append(found.response)
        noise.append(found.noise)
        total.append(found.total)
    scatter = np.var(response, axis=0)
    np.testing.assert_allclose(np.mean(noise, axis=0), scatter, rtol=0.2)
    np.testing.assert_allclose(np.mean(total, axis=0), scatter, rtol=0.2)
