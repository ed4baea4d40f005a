"""Output-error estimates of windows, and the intervals between and beyond them."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from dea.errors import InputError
from dea.narx import NarxModel, Scaling, refine, simulate, simulate_varying
from dea.tracking import track_parameters
from dea.tracking.local import WindowEstimates, local_estimates
from dea.tracking.scatter import _by_chance, _uncertain, widened

PLANT = NarxModel.from_terms({"1": 0.1, "y(t-1)": 0.8, "u(t-1)": 0.5}, scaling=Scaling())
NOISE = 0.02


def record(samples, course=None, seed=1):
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.standard_normal(samples // 5), 5)
    if course is None:
        course = np.tile(PLANT.parameters, (samples, 1))
    clean = simulate_varying(PLANT.terms, course, u, np.full(1, 0.5))
    return u, clean + NOISE * rng.standard_normal(samples)


def ramp(samples, change=0.2):
    """The input's parameter rises by a fifth, steadily."""
    course = np.tile(PLANT.parameters, (samples, 1))
    course[:, 2] *= 1.0 + change * np.linspace(0.0, 1.0, samples)
    return course


def test_a_window_has_the_least_free_run_error_beside_a_level_that_creeps():
    """Against a general minimiser on differences, with a parabola of time added to the run."""
    u, y = record(400)
    y = y + 0.3 * np.linspace(-1.0, 1.0, 400) + 0.1 * np.linspace(-1.0, 1.0, 400) ** 2
    found = local_estimates(PLANT, u, y, 400)
    time = np.linspace(-1.0, 1.0, 400)

    def error(x):
        return simulate(PLANT.terms, x[:3], u, x[3:4]) + x[4] * time + x[5] * time**2 - y

    best = least_squares(error, [*PLANT.parameters, 0.5, 0.0, 0.0], xtol=1e-12)
    np.testing.assert_allclose(found.theta[0], best.x[:3], rtol=0.01 * NOISE)


def test_constant_parameters_are_near_those_refined_on_the_whole_record():
    u, y = record(8000)
    whole = refine(PLANT, u, y)
    track = track_parameters(PLANT, u, y, method="local")
    deviation = np.sqrt(np.einsum("kii->ki", track["covariance"].values))
    at = track["parameter"].sel(time=track["instant"]).values
    assert np.all(np.abs(at - whole.parameters) < 4 * deviation)
    assert np.all(deviation > whole.standard_errors)
    # An eighth of the record: the square root of eight as wide, more beyond the outer centres.
    assert np.median(deviation[:, 1:] / whole.standard_errors[1:]) < 4.5


def test_intervals_hold_parameters_that_drift():
    inside = []
    for seed in range(8):
        course = ramp(4000)
        u, y = record(4000, course, seed)
        track = track_parameters(PLANT, u, y, method="local", window=500, instants=20)
        assert track.attrs["withheld"] == ""
        true = course[track["instant"].values.astype(int)]
        inside.append((track["band_low"] <= true) & (true <= track["band_high"]))
    assert 0.9 <= np.mean(inside) <= 0.99


def test_a_steady_drift_cancels_at_the_centre():
    """Without noise what is left of a drift of 20 % is far below its course within a window."""
    course = ramp(4000)
    u, _ = record(4000)
    y = simulate_varying(PLANT.terms, course, u, np.full(1, 0.5))
    found = local_estimates(PLANT, u, y, 1000)
    error = found.theta - course[found.centre.astype(int)]
    assert np.abs(error[:, 2]).max() < 0.1 * (course[1000, 2] - course[0, 2])


def test_between_and_beyond_centres_estimates_are_combined_with_what_they_share():
    """The variance of a weighted sum of means, by the matrix of which sample is in which."""
    length = 8
    centre = np.array([3.5, 7.5, 11.5, 15.5])
    means = np.array([(np.abs(np.arange(20) - c) < length / 2) / length for c in centre])
    theta = np.array([[1.0], [3.0], [4.0], [8.0]])
    estimates = WindowEstimates(centre, theta, np.full((4, 1, 1), 1.0 / length), length, 0, 0.0)
    for t, weights in (
        (3.5, [1, 0, 0, 0]),
        (8.5, [0, 0.75, 0.25, 0]),
        (0.0, [1 + 3.5 / 8, 0, -3.5 / 8, 0]),
        (18.0, [0, -2.5 / 8, 0, 1 + 2.5 / 8]),
    ):
        value, covariance = estimates.at(np.array([t]))
        row = np.array(weights) @ means
        np.testing.assert_allclose(value[0], np.array(weights) @ theta)
        np.testing.assert_allclose(covariance[0, 0, 0], row @ row, rtol=1e-12)


def test_windows_that_have_no_samples_in_common_are_independent():
    estimates = WindowEstimates(
        np.array([4.0, 24.0]), np.zeros((2, 1)), np.ones((2, 1, 1)), 8, 0, 0.0
    )
    _, covariance = estimates.at(np.array([4.0, 9.0, 14.0, 24.0]))
    np.testing.assert_allclose(covariance[:, 0, 0], [1.0, 0.75**2 + 0.25**2, 0.5, 1.0])


@pytest.mark.parametrize("units", [np.eye(2), np.diag([1e3, 1e-3]), [[1.0, 2.0], [-3.0, 0.5]]])
def test_a_covariance_is_wider_where_separate_windows_scatter_more(units):
    """Independent windows; in one direction nine times the variance stated, in one half of it."""
    rng, count = np.random.default_rng(2), 2000
    centre = 100.0 * np.arange(count)
    noise = np.array([[1.0, 0.0], [0.9, 0.1]])
    scattered = noise @ np.diag([3.0, np.sqrt(0.5)])
    drift = np.outer(np.arange(count), [3.0, -1.0])
    theta = drift + rng.standard_normal((count, 2)) @ scattered.T
    covariance = np.tile(noise @ noise.T, (count, 1, 1))
    units = np.asarray(units)
    found = widened(centre, theta @ units.T, units @ covariance @ units.T, 100)
    expected = units @ noise @ np.diag([9.0, 1.0]) @ noise.T @ units.T
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(found[0] / scale, expected / scale, atol=0.1)


def test_one_window_in_another_minimum_widens_no_other():
    rng = np.random.default_rng(3)
    theta, covariance = rng.standard_normal((100, 2)), np.tile(np.eye(2), (100, 1, 1))
    theta[50] += 1e3
    found = widened(100.0 * np.arange(100), theta, covariance, 100)
    assert np.linalg.eigvalsh(found).max() < 2.0


def test_without_three_separate_windows_the_noise_alone_is_known():
    covariance = np.tile(np.eye(2), (9, 1, 1))
    theta = np.random.default_rng(4).standard_normal((9, 2))
    assert np.array_equal(widened(12.5 * np.arange(9), theta, covariance, 100), covariance)


def _first_of_eight_windows(records, ratio):
    """Return means of white noise over eight windows' length and their variance; 1 is stated."""
    rng, overlap, separate = np.random.default_rng(5), 8, 8
    noise = rng.standard_normal((records, overlap * separate)) * np.sqrt(ratio * overlap)
    theta = np.lib.stride_tricks.sliding_window_view(noise, overlap, axis=1).mean(axis=-1)
    centre, stated = np.arange(theta.shape[1]) + 0.0, np.ones((theta.shape[1], 1, 1))
    found = [widened(centre, estimates[:, None], stated, overlap)[0, 0, 0] for estimates in theta]
    return theta[:, 0], np.array(found)


def test_a_normal_quantile_of_an_uncertain_variance_is_students():
    """t of 4 degrees of freedom is 2.776 where a normal distribution has 1.960."""
    found = _uncertain(np.array([100.0]), 4.0)
    np.testing.assert_allclose(1.960 * np.sqrt(found), 2.776 * 10.0, rtol=1e-3)


def test_an_interval_holds_where_few_windows_tell_how_far_estimates_scatter():
    error, variance = _first_of_eight_windows(2000, ratio=9.0)
    assert 0.93 < np.mean(np.abs(error) < 1.96 * np.sqrt(variance)) < 0.97


def test_where_nothing_scatters_few_windows_widen_little():
    _, variance = _first_of_eight_windows(2000, ratio=1.0)
    assert 1.0 <= variance.mean() < 1.3


@pytest.mark.parametrize("directions", [1, 2, 4, 10])
@pytest.mark.parametrize("freedom", [7, 40])
def test_what_noise_exceeds_by_chance_is_that_of_the_largest_direction(directions, freedom):
    noise = np.random.default_rng(8).standard_normal((4000, freedom, directions))
    largest = np.linalg.eigvalsh(noise.swapaxes(1, 2) @ noise / freedom)[:, -1]
    assert 0.02 < np.mean(largest > _by_chance(directions, freedom)) < 0.08


@pytest.mark.parametrize(("window", "few"), [(None, False), (500, False), (501, True)])
def test_a_record_of_few_windows_has_no_intervals(window, few):
    u, y = record(4000)
    track = track_parameters(PLANT, u, y, method="local", window=window)
    assert bool(track.attrs["withheld"]) is few
    assert track["band_low"].isnull().all() == few
    assert track.attrs["window"] == (window or 500)
    if few:
        assert track.attrs["withheld"].endswith("take a window of 500 samples")
        # Not "8.0 windows", which are enough.
        assert track.attrs["withheld"].startswith("the record has 7.9 windows that do not overlap")


def test_a_window_of_too_few_samples_is_refused():
    u, y = record(500)
    with pytest.raises(InputError, match="window: 10 samples"):
        track_parameters(PLANT, u, y, method="local", window=10)


def test_a_record_shorter_than_a_window_has_constant_parameters():
    u, y = record(500)
    track = track_parameters(PLANT, u, y, method="local", window=1000)
    np.testing.assert_allclose(track["parameter"], track["parameter"][:1] * np.ones((500, 1)))


def test_a_model_without_a_bounded_run_is_refused():
    u, y = record(2000)
    unstable = NarxModel.from_terms({"y(t-1)^3": 1e4, "u(t-1)": 0.5}, scaling=Scaling())
    with pytest.raises(InputError, match="diverges in every window"):
        track_parameters(unstable, u, y + 1.0, method="local", window=400)


@pytest.mark.parametrize("short", [slice(0, 1200), slice(2800, 4000)], ids=["first", "last"])
def test_a_window_whose_run_diverges_begins_from_another(short):
    """An unstable model: only runs between missing outputs, which are short, stay bounded."""
    unstable = NarxModel(PLANT.terms, PLANT.parameters * [1.0, 1.29, 1.0], scaling=Scaling())
    u, y = record(4000)
    gaps = np.arange(short.start, short.stop, 40)
    y[gaps] = np.nan
    found = local_estimates(unstable, u, y, 1000)
    assert found.failed == 0
    np.testing.assert_allclose(found.theta, np.tile(PLANT.parameters, (25, 1)), atol=0.03)


def test_missing_outputs_are_left_out():
    u, y = record(8000)
    whole = track_parameters(PLANT, u, y, method="local")
    gaps = y.copy()
    gaps[[700, 1500, 1501]] = np.nan
    track = track_parameters(PLANT, u, gaps, method="local")
    deviation = np.sqrt(np.einsum("kii->ki", whole["covariance"].values))
    moved = (track["parameter"] - whole["parameter"]).sel(time=track["instant"]).values
    # Each stretch has a trend of its own, so that the constant is determined anew.
    assert 0.0 < np.abs(moved / deviation)[:, 1:].max() < 1.0
    assert track.attrs["withheld"] == ""


def test_the_innovation_is_the_error_of_the_prediction_from_what_was_measured():
    u, y = record(2000)
    track = track_parameters(PLANT, u, y, method="local")
    theta = track["parameter"].values[1:]
    predicted = theta[:, 0] + theta[:, 1] * y[:-1] + theta[:, 2] * u[:-1]
    np.testing.assert_allclose(track["innovation"].values[1:], y[1:] - predicted, atol=1e-9)
