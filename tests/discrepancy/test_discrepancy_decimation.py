"""Long records at fewer samples: how many, and what a device does with them."""

import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter, lsim

from dea.discrepancy import Budget, Settings
from dea.discrepancy.problem.decimation import decimated, decimation_of, interpolation_of
from dea.discrepancy.problem.problem import Samples
from dea.discrepancy.problem.records import prepare
from dea.simulation import ExtendedSimulation, load_simulation
from dea.simulation.interpolation import at_steps

RATE, SIZE = 50.0, 20_000
RNG = np.random.default_rng(1)
SETTINGS = Settings(budget=Budget(decimated=5000))


def multisine(highest, size=SIZE, rate=RATE):
    """Return a sum of sines below a ``highest`` frequency (Hz), of deviation one."""
    spectrum = np.zeros(size // 2 + 1, complex)
    lines = slice(1, int(highest * size / rate) + 1)
    spectrum[lines] = np.exp(2j * np.pi * RNG.random(lines.stop - 1))
    u = np.fft.irfft(spectrum, size)
    return u / np.std(u)


def held(u, time_constant, interval):
    """Return the response (n,) of a first-order lag to an input that is held, exactly."""
    b, a, *_ = cont2discrete(([1.0], [time_constant, 1.0]), interval, method="zoh")
    return lfilter(b.ravel(), a, u)


def record(u, y=None, noise=0.01):
    y = held(u, 0.3, 1 / RATE) if y is None else y
    return Samples(u, y + noise * RNG.standard_normal(y.size), 1 / RATE)


@pytest.mark.parametrize(
    ("highest", "size", "factor"),
    [
        (1.0, 2000, 5),
        (0.5, 2000, 10),
        (0.5, 5000, 4),
        (4.0, 2000, 1),
        (1.0, SIZE, 1),
        (1.0, 11_000, 1),
    ],
)
def test_an_input_keeps_ten_samples_in_a_period_of_its_band(highest, size, factor):
    assert decimation_of([record(multisine(highest))], size) == factor


def test_noise_beyond_the_band_does_not_keep_a_record_long():
    assert decimation_of([record(multisine(1.0), noise=0.2)], 2000) == 5


def test_an_output_that_rings_beyond_what_would_be_kept_does():
    u = multisine(1.0)
    t = np.arange(SIZE) / RATE
    ringing = held(u, 0.3, 1 / RATE) + 0.1 * np.sin(2 * np.pi * 9.0 * t)
    assert decimation_of([record(u, ringing)], 2000) == 2


def test_a_white_input_keeps_all_its_samples():
    assert decimation_of([record(RNG.standard_normal(SIZE))], 2000) == 1


def test_the_fastest_of_several_records_or_inputs_counts():
    slow, fast = multisine(0.5), multisine(1.5)
    both = Samples(np.column_stack([slow, fast]), record(slow).y, 1 / RATE)
    assert decimation_of([record(slow), record(fast)], 2000) == 3
    assert decimation_of([both], 2000) == 3


@pytest.mark.parametrize("time_constant", [0.3, 2.0])
def test_a_lag_behind_a_held_input_moves_as_before(time_constant):
    u = multisine(1.0)
    whole = Samples(u, held(u, time_constant, 1 / RATE), 1 / RATE)
    short = decimated(whole, 5, "zero", "zero")
    found = held(short.u, time_constant, short.interval)
    assert short.interval == pytest.approx(5 / RATE)
    np.testing.assert_array_equal(short.y, whole.y[::5])
    assert np.std(found - short.y) < 0.01 * np.std(short.y)


@pytest.mark.parametrize("time_constant", [0.03, 0.3, 2.0])
def test_a_lag_behind_a_held_smooth_input_moves_as_before(time_constant):
    """Also one that is faster than the longer interval, which a mean would move late and less."""
    u = multisine(1.0)
    whole = Samples(u, held(u, time_constant, 1 / RATE), 1 / RATE)
    errors = {}
    for how in ("zero", "smooth"):
        short, steps = decimated(whole, 5, "zero", how), 20
        fine = at_steps(short.u, steps, how)
        times = np.arange(fine.size) * short.interval / steps
        _, found, _ = lsim(([1.0], [time_constant, 1.0]), fine, times, interp=how == "smooth")
        # The first motion is that of another start; the last samples have no further input.
        errors[how] = np.std((found[:-1:steps] - short.y)[100:-20]) / np.std(short.y)
    assert errors["smooth"] < 5e-3
    assert errors["smooth"] < 0.35 * errors["zero"]


@pytest.mark.parametrize("recorded", ["zero", "linear", "smooth"])
def test_a_smooth_input_is_decimated_as_one(recorded):
    u = np.column_stack([multisine(1.0), 3.0 + 0.1 * multisine(0.5)])
    assert interpolation_of([Samples(u, u[:, 0], 1 / RATE)], 5, recorded) == "smooth"


@pytest.mark.parametrize("recorded", ["zero", "linear"])
def test_an_input_that_jumps_is_decimated_as_recorded(recorded):
    u = np.repeat(RNG.uniform(1.0, 3.0, 20), SIZE // 20)
    assert interpolation_of([record(u)], 7, recorded) == recorded


@pytest.mark.slow
@pytest.mark.parametrize(("size", "highest"), [(0.2, np.inf), (0.5, 3.8)])
def test_a_decimated_record_is_simulated_as_the_whole_one(size, highest):
    """The film follows within a few milliseconds, a fiftieth of the interval that would be allowed.

    It moves most where a clipped input has its corners.
    """
    u, own = np.minimum(2.3 + size * multisine(1.0), highest), load_simulation("dea_film")
    whole = ExtendedSimulation(own, substeps=4)
    y = whole.simulate(whole.layout.prior_means, u, 1 / RATE)
    noisy = Samples(u, y + 0.005 * np.std(y) * RNG.standard_normal(y.size), 1 / RATE)
    problem, _, extended = prepare([noisy], own, SETTINGS)
    assert problem.oversampled
    assert problem.decimation < decimation_of([noisy], SETTINGS.budget.decimated)
    assert extended.substeps == 1
    step = problem.decimation
    values = extended.layout.prior_means
    found = extended.simulate(values, problem.u, step / RATE)
    recorded = extended.as_recorded.simulate(values, u, 1 / RATE)
    assert np.std((found - y[::step])[20:]) < 0.0025 * np.std(y)
    assert np.std((recorded - y)[20:]) < 0.0025 * np.std(y)


def test_an_input_that_is_not_held_is_taken_where_the_output_is():
    u = np.column_stack([np.arange(103.0), -np.arange(103.0)])
    y = np.where(np.arange(103) == 10, np.nan, 1.0)
    short = decimated(Samples(u, y, 0.1), 5, "linear", "linear")
    np.testing.assert_array_equal(short.u[:, 0], np.arange(0.0, 100.0, 5.0))
    assert short.y.shape == (20,)
    assert np.isnan(short.y[2])


@pytest.mark.parametrize(("seconds", "rate"), [(500.0, RATE), (1000.0, RATE / 3)])
def test_a_record_is_decimated_to_no_fewer_samples_than_the_budget_says(seconds, rate):
    size = round(seconds * RATE)
    u = 2.0 + multisine(1.0, size)
    settings = Settings.of(
        {
            "discrepancy": {
                "effects": [],
                "warm_up": 1.0,
                "budget": {"decimated": 15_000},
                "rules": {},
            },
            "seed": 1,
            "system": "lag",
        }
    )
    own = load_simulation("mass_spring_damper")
    problem, _, extended = prepare([record(u)], own, settings)
    assert problem.interval == pytest.approx(1 / rate)
    assert problem.recorded_interval == pytest.approx(1 / RATE)
    timing = extended.layout.parameters[extended.layout.names.index("timing_offset")]
    assert timing.spread == pytest.approx(0.4 / RATE)
