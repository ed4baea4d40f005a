"""What the structure of a model lacks, against linear systems whose responses are known."""

import numpy as np
import pytest
import xarray as xr
from scipy.signal import freqz, lfilter

from dea.excitation import design
from dea.gfrf import Grid, response_over_time
from dea.gfrf.model_error import ModelErrorModel, _deviations, model_error
from dea.gfrf.relative_error import RelativeError, relative_error
from dea.narx import NarxModel, Scaling

RATE = 50.0
FAST = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.2}, scaling=Scaling())
# Beside it in parallel, a slow pole that the model lacks.
SLOW = [0.0, 5e-4], [1.0, -0.99]


def excitation(samples, seed):
    return lfilter([0.1], [1.0, -0.9], np.random.default_rng(seed).standard_normal(samples))


def outputs(u, slow=True, noise=0.0, seed=9):
    y = lfilter([0.0, 0.2], [1.0, -0.8], u) + slow * lfilter(*SLOW, u)
    return y + noise * y.std() * np.random.default_rng(seed).standard_normal(u.size)


def lacking(u, y, model=FAST, excited_above=1e-3):
    course = np.tile(model.parameters, (len(u), 1))
    return model_error(model, course, u, y, RATE, excited_above)


def test_a_slow_pole_beside_the_models_own_is_seen_at_every_frequency():
    u = excitation(90_000, 1)
    found = lacking(u, outputs(u, noise=0.003))
    _, slow = freqz(*SLOW, found.frequency, fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], found.frequency, fs=RATE)
    relative = slow / (fast + slow)
    # At the lowest line the mean around it is of the lines above.
    band = (found.frequency > 0.04) & (found.frequency < 0.5)
    np.testing.assert_allclose(found.gain[0][band], np.abs(relative.real)[band], atol=0.002)
    np.testing.assert_allclose(found.phase[0][band], np.abs(relative.imag)[band], atol=0.002)


@pytest.mark.parametrize("colour", [0.0, 0.95])
def test_noise_alone_is_seldom_taken_for_an_error(colour):
    seen = []
    for seed in range(20):
        u = excitation(16_000, seed)
        white = np.random.default_rng(100 + seed).standard_normal(u.size)
        noise = lfilter([1.0], [1.0, -colour], white)
        found = lacking(u, outputs(u, slow=False) + 0.05 * u.std() * noise / noise.std())
        seen += (found.gain[0] > 0.0).tolist()
    # One of a hundred at the line itself, and one around it.
    assert np.mean(seen) < 0.02


def test_an_error_that_noise_hides_at_most_lines_is_seen_around_them():
    """Where single lines show it in a few records.

    It counts with the noise that its measurement has: it is not smaller than it is on average, and
    at most by half larger.
    """
    sizes, true = [], []
    for seed in range(10):
        u = excitation(24_000, seed)
        found = lacking(u, outputs(u, noise=0.1, seed=100 + seed))
        _, slow = freqz(*SLOW, found.frequency, fs=RATE)
        _, fast = freqz([0.0, 0.2], [1.0, -0.8], found.frequency, fs=RATE)
        band = (found.frequency > 0.1) & (found.frequency < 0.4)
        sizes.append(np.hypot(found.gain, found.phase)[0][band])
        true.append(np.abs(slow / (fast + slow))[band])
    assert np.mean(np.array(sizes) > 0.0) > 0.95
    assert 1.0 < np.sqrt(np.mean(np.square(sizes)) / np.mean(np.square(true))) < 1.5


def test_of_two_inputs_the_one_whose_response_lacks_something_is_told():
    u = np.stack([excitation(60_000, 1), excitation(60_000, 2)], axis=1)
    model = NarxModel.from_terms({"y(t-1)": 0.8, "u1(t-1)": 0.2, "u2(t-1)": 0.2}, scaling=Scaling())
    y = outputs(u[:, 0]) + outputs(u[:, 1], slow=False)
    found = lacking(u, y, model)
    band = (found.frequency > 0.03) & (found.frequency < 0.3)
    size = np.hypot(found.gain, found.phase)[:, band]
    _, slow = freqz(*SLOW, found.frequency[band], fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], found.frequency[band], fs=RATE)
    np.testing.assert_allclose(size[0], np.abs(slow / (slow + fast)), atol=0.01)
    assert np.median(size[1]) < 0.1 * np.median(size[0])


@pytest.mark.parametrize(("segments", "told"), [(7, False), (8, False), (9, True), (12, True)])
def test_fewer_than_eight_independent_segments_tell_nothing(segments, told):
    """Neighbours that share a half count for 18/19 of one (Welch 1967, Hann's window)."""
    u = excitation(90_000, 1)
    y = outputs(u, noise=0.01)
    y[4000 + 2000 * (segments - 1) :] = np.nan
    assert (lacking(u, y) is not None) == told


def test_stretches_with_missing_outputs_are_left_out():
    u = excitation(90_000, 1)
    y = outputs(u)
    whole = lacking(u, y)
    y[::30_000] = np.nan
    found = lacking(u, y)
    np.testing.assert_array_equal(found.frequency, whole.frequency)
    band = whole.frequency < 0.3
    np.testing.assert_allclose(found.phase[0][band], whole.phase[0][band], atol=0.002)


def test_a_record_that_does_not_tell_gives_none():
    u = excitation(4000, 1)
    unstable = NarxModel(FAST.terms, np.array([1.1, 0.2]), scaling=Scaling())
    assert lacking(u, outputs(u), unstable) is None
    assert lacking(u[:50], outputs(u[:50])) is None
    y = outputs(u)
    y[::400] = np.nan
    assert lacking(u, y) is None


def responses(u, y=None, model=FAST, deviation=1e-3):
    """Responses of a model whose parameters are known so well."""
    times = np.arange(u.size) / RATE
    covariance = deviation**2 * np.eye(len(model.terms))
    track = xr.Dataset(
        {
            "parameter": (("time", "term"), np.tile(model.parameters, (u.size, 1))),
            "covariance": (
                ("instant", "term", "term_2"), np.tile(covariance, (3, 1, 1))
            ),
        },
        coords={
            "time": times, "instant": times[[10, 100, 1000]], "term": list(map(str, model.terms)),
        },
        attrs={"estimator": "local", "withheld": ""},
    )  # fmt: skip
    grid = Grid(instants=3, lowest=1e-3, highest=0.01, count=20, plane_highest=0.01, plane_count=4)
    return response_over_time(model, track, u, RATE, y=y, grid=grid)


def test_the_band_holds_the_response_that_the_structure_cannot_have():
    u = excitation(90_000, 1)
    found, alone = responses(u, outputs(u)), responses(u)
    f = found["frequency"].values
    true = sum(freqz(*each, f, fs=RATE)[1] for each in (([0.0, 0.2], [1.0, -0.8]), SLOW))
    gain, phase = np.abs(true), np.degrees(np.angle(true))

    def inside(band):
        return (
            (band["gain_low"] <= gain) & (gain <= band["gain_high"])
            & (band["phase_low"] <= phase) & (phase <= band["phase_high"])
        ).values  # fmt: skip

    assert inside(found).all()
    assert inside(alone).mean() < 0.5


def test_where_nothing_is_lacking_the_band_is_that_of_the_parameters():
    u = excitation(90_000, 1)
    found, alone = responses(u, outputs(u, slow=False, noise=0.01)), responses(u)
    wider = (found["gain_high"] / found["gain_low"]) / (alone["gain_high"] / alone["gain_low"])
    assert wider.median() == 1.0
    assert wider.max() < 1.01


SQUARE, LAGGING = 0.3, 0.5  # shares of the square, and of that which the slow pole alone answers


def bent(u):
    """What follows u and its square at once, and a slow part of the square, which BENT lacks."""
    at_once = lfilter([0.0, 0.2], [1.0, -0.8], u + SQUARE * u**2)
    return at_once + LAGGING * lfilter(*SLOW, u**2)


BENT = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.2, "u(t-1)^2": 0.2 * SQUARE})


@pytest.mark.parametrize("level", [0.0, 0.4])
def test_what_the_square_of_the_input_drives_is_told_from_what_the_input_does(level):
    """About another operating point, the slow part of the square is one of H1, too."""
    u = excitation(90_000, 1) + 0.3  # not centred, so that u and its square are correlated
    course = np.tile(BENT.parameters, (u.size, 1))
    found = model_error(BENT, course, u, bent(u), RATE, 1e-3, operating_point=level)
    f = found.frequency[(found.frequency > 0.03) & (found.frequency < 0.3)]
    _, slow = freqz(*SLOW, f, fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], f, fs=RATE)
    second = LAGGING * slow / (SQUARE * fast + LAGGING * slow)
    lagging = 2.0 * level * LAGGING * slow
    first = lagging / ((1.0 + 2.0 * level * SQUARE) * fast + lagging)
    for (gain, phase), true in ((found.product(f), second), (found.first(f), first)):
        np.testing.assert_allclose(gain, np.abs(true.real), atol=0.01)
        np.testing.assert_allclose(phase, np.abs(true.imag), atol=0.01)
    pairs = f[:5, None], f[None, :5]
    gain, phase = found.second(*pairs)
    assert (gain >= found.product(sum(pairs))[0]).all()
    np.testing.assert_array_equal(phase, phase.T)


def test_the_band_of_h2_holds_what_the_square_drives():
    u = excitation(90_000, 1)
    found, alone = (responses(u, y, BENT, 1e-4) for y in (bent(u), None))
    f1, f2 = found["frequency_1"].values[:, None], found["frequency_2"].values
    _, slow = freqz(*SLOW, (f1 + f2).ravel(), fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], (f1 + f2).ravel(), fs=RATE)
    true = np.abs(SQUARE * fast + LAGGING * slow).reshape(len(f1), -1)

    def inside(band):
        return ((band["H2_gain_low"] <= true) & (true <= band["H2_gain_high"])).values

    assert inside(found).all()
    assert not inside(alone).any()


@pytest.mark.parametrize("levels", [(-0.5, 0.5), (0.1, 0.4), (0.3, 1.0), (-1.0, 0.0, 1.0)])
def test_an_input_of_few_levels_tells_of_as_many_powers_fewer_one(levels):
    """Of two, the square is constant but for rounding; of three, the cube is made up by others."""
    u = np.repeat(np.random.default_rng(1).choice(levels, 9000), 10)
    y, course = outputs(u), np.tile(FAST.parameters, (u.size, 1))
    middle = 0.5 * (levels[0] + levels[-1])
    found = model_error(FAST, course, u, y, RATE, 1e-3, operating_point=middle)
    _, slow = freqz(*SLOW, found.frequency, fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], found.frequency, fs=RATE)
    band = (found.frequency > 0.03) & (found.frequency < 0.5)
    relative = np.abs(slow / (fast + slow))[band]
    np.testing.assert_allclose(np.hypot(found.gain, found.phase)[0][band], relative, atol=0.003)
    assert np.isnan(found.pair_gain).all() == (len(levels) == 2)
    if len(levels) == 2:
        gain, _ = found.second(np.array([0.1]), np.array([0.1]))
        assert gain == 0.0


@pytest.mark.parametrize("period", [27.3, 30.0])
def test_a_periodic_input_tells_of_h1_alone(period):
    """All segments are alike, so that at each line the powers cannot be told apart."""
    u = design(
        "multisine", duration=1800, sampling_rate=RATE, low=-1, high=1, seed=1, period=period
    )
    found = lacking(u, outputs(u, noise=1e-3))
    _, slow = freqz(*SLOW, found.frequency, fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], found.frequency, fs=RATE)
    size = np.hypot(found.gain, found.phase)[0]
    assert np.median(size / np.abs(slow / (fast + slow))) == pytest.approx(1.0, abs=0.2)
    assert np.isnan(found.pair_gain).all()


def test_the_error_of_a_product_is_told_by_its_pair():
    """u1 has two levels, so that its square tells nothing; only u1 u2 lags in the device."""
    u1 = np.repeat(np.random.default_rng(1).choice([-1.0, 1.0], 9000), 10)
    u2 = excitation(90_000, 2)
    terms = {"y(t-1)": 0.8, "u1(t-1)": 0.2, "u2(t-1)": 0.2, "u1(t-1)u2(t-1)": 0.2}
    model = NarxModel.from_terms(terms, scaling=Scaling())
    y = outputs(u1 + u2, slow=False) + outputs(u1 * u2)
    found = lacking(np.stack([u1, u2], axis=1), y, model)
    f = found.frequency[(found.frequency > 0.04) & (found.frequency < 0.3)]
    _, slow = freqz(*SLOW, f, fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], f, fs=RATE)
    np.testing.assert_allclose(
        np.hypot(*found.product(f, (2, 1))), np.abs(slow / (slow + fast)), atol=0.005
    )
    assert np.isnan(found.product(f, (1, 1))).all()
    for nothing in (found.product(f, (2, 2)), found.first(f, 1), found.first(f, 2)):
        assert np.median(np.hypot(*nothing)) < 0.002


def test_h2_has_the_errors_of_h1_at_three_frequencies_and_of_the_product_at_their_sum():
    lines = np.array([0.1, 0.2, 0.3, 0.5])
    gain, phase = np.array([[1.0, 2.0, 3.0, 4.0]]), np.array([[0.1, 0.2, 0.3, 0.4]])
    known = ModelErrorModel(lines, gain, phase, 10.0 * gain, 10.0 * phase)
    for sign in (1.0, -1.0):
        found = known.second(np.array([0.1, 0.5, 0.1]) * sign, np.array([0.2, -0.3, 0.9]) * sign)
        wanted = np.sqrt([1 + 4 + 9 + 900, 16 + 9 + 4 + 400, 1 + 16 + 16 + 1600])
        np.testing.assert_allclose(found, [wanted, 0.1 * wanted])


def test_what_counts_holds_the_noise_of_its_measurement():
    """Half of the variance of a complex value is that of its real part, half of its imaginary."""
    f = np.linspace(0.1, 1.0, 10)
    certain = RelativeError(f, np.full((1, 10), 0.3 + 0.1j), np.full((1, 10), 0.002), 50.0, 1.0)
    gain, phase = _deviations(certain)[:, 0]
    np.testing.assert_allclose(gain, np.sqrt(0.3**2 + 0.001))
    np.testing.assert_allclose(phase, np.sqrt(0.1**2 + 0.001))


@pytest.mark.slow
def test_the_variance_of_a_relative_error_is_that_over_repeated_noise():
    u = excitation(40_000, 1)
    y, slow = outputs(u), lfilter(*SLOW, u)
    powers = np.array([u, u**2, u**3])
    seen = np.ones(u.size, bool)
    found = []
    for seed in range(100):
        noise = 0.02 * y.std() * np.random.default_rng(seed).standard_normal(u.size)
        found.append(relative_error(powers, 1, y + noise, slow + noise, seen, RATE, 1e-3))
    f = found[0].frequency
    # Lower lines hold leakage from those below; at higher ones the output's own noise counts.
    band = (f > 0.05) & (f < 2.0)
    values = np.array([each.relative[0][band] for each in found])
    stated = np.mean([each.variance[0][band] for each in found], axis=0)
    scatter = np.mean(np.abs(values - values.mean(axis=0)) ** 2, axis=0)
    assert np.median(scatter / stated) == pytest.approx(1.0, abs=0.1)
    _, slow = freqz(*SLOW, f[band], fs=RATE)
    _, fast = freqz([0.0, 0.2], [1.0, -0.8], f[band], fs=RATE)
    np.testing.assert_allclose(values.mean(axis=0), slow / (slow + fast), atol=0.002)


def zero_square(u):
    return outputs(u, slow=False)


@pytest.mark.parametrize(
    ("device", "terms"),
    [
        (zero_square, {"y(t-1)": 0.8, "u(t-1)": 0.2, "u(t-1)^2": 0.2}),
        (lambda u: 0.0 * u, {"y(t-1)": 0.8, "u(t-1)": 0.2, "u(t-1)^2": 0.2}),
        (lambda u: 0.0 * u + 1.0, {"y(t-1)": 0.8, "u(t-1)": 0.2}),
    ],
)
def test_a_response_that_the_device_has_not_has_no_interval(device, terms):
    u = excitation(90_000, 1)
    model = NarxModel.from_terms(terms, scaling=Scaling())
    found = responses(u, device(u), model)
    if device is not zero_square:
        assert found["gain_high"].isnull().all()
    assert found["H2_gain_high"].isnull().all()


@pytest.mark.parametrize("second", [np.zeros(40_000), np.full(40_000, 0.3)])
def test_an_input_that_rests_tells_nothing(second):
    u = np.stack([excitation(40_000, 1), second], axis=1)
    model = NarxModel.from_terms({"y(t-1)": 0.8, "u1(t-1)": 0.2, "u2(t-1)": 0.2}, scaling=Scaling())
    assert lacking(u, outputs(u[:, 0]), model) is None
    assert lacking(second, outputs(second)) is None


def test_noise_alone_is_rarely_taken_for_an_error_at_any_line():
    """In one record in a hundred at a line, if segments that overlap were independent."""
    taken = []
    for seed in range(400):
        u = np.random.default_rng(seed).standard_normal(8_000)
        y = outputs(u, slow=False)
        y += 0.1 * np.random.default_rng(1000 + seed).standard_normal(u.size)
        found = lacking(u, y)
        taken.append((found.gain[0] + found.phase[0] > 0.0).any())
    assert 0.005 < np.mean(taken) < 0.05
