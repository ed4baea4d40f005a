"""The inverse along a reference: against closed forms, brute force and the model itself."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from dea.control import RecedingHorizonInverse, inverse_of
from dea.control.planning_kernels import output_and_slopes
from dea.errors import InputError
from dea.narx import Labels, NarxModel, Scaling
from dea.terms import Term
from published_plants import published_plants

RATE = 50.0
SCALING = Scaling(u_offset=2.4, u_scale=1.3, y_offset=0.5, y_scale=0.4)
PLANT = NarxModel(published_plants()["DEA2"].terms, published_plants()["DEA2"].parameters, SCALING)
LINEAR = NarxModel(
    tuple(map(Term.parse, ("1", "y(t-1)", "y(t-2)", "u(t-1)", "u(t-2)"))),
    np.array([0.0, 1.2, -0.3, 0.3, -0.1]),
    Scaling(0.0, 1.0, 0.0, 1.0),
)


def inverse(model=PLANT, **changes):
    settings = {"horizon": 12, "smoothness": 1e-4, "lowest": 1.4, "highest": 3.4, "rate": 40.0}
    return RecedingHorizonInverse(model, **{"sampling_rate": RATE} | settings | changes)


def rest(model, u):
    return float(model.simulate(np.full(4000, u))[-1])


def smooth_reference(samples):
    low, high = rest(PLANT, 2.0), rest(PLANT, 2.8)
    time = np.arange(samples) / RATE
    return 0.5 * (low + high) + 0.4 * (high - low) * np.sin(2 * np.pi * 0.5 * time)


def test_the_model_follows_the_reference_with_the_inputs_of_its_inverse():
    reference = smooth_reference(500)
    u = inverse_of(inverse(), reference, 2.4, rest(PLANT, 2.4))
    y = PLANT.simulate(np.concatenate([np.full(4000, 2.4), u]))[4000:]
    error = (y - reference)[50:]
    assert np.sqrt(np.mean(error**2)) < 2e-3 * np.ptp(reference)


def test_one_step_is_the_minimum_that_a_general_optimiser_finds():
    """Of a linear model one Gauss-Newton step is exact, wherever it begins."""
    horizon, weight = 8, 0.02
    chosen = inverse(LINEAR, horizon=horizon, smoothness=weight, lowest=-50, highest=50, rate=1e6)
    wanted = np.sin(np.arange(horizon))
    chosen.rest(0.2, 0.3)
    found = chosen.step(wanted)

    def cost(u):
        inputs = np.concatenate([[0.2, 0.2], u])
        y = [0.3, 0.3]
        for t in range(2, horizon + 2):
            y.append(1.2 * y[-1] - 0.3 * y[-2] + 0.3 * inputs[t - 1] - 0.1 * inputs[t - 2])
        return np.sum((np.array(y[2:]) - wanted) ** 2) + weight * np.sum(np.diff(inputs, 2) ** 2)

    best = minimize(cost, np.zeros(horizon), method="BFGS", options={"gtol": 1e-10})
    assert found == pytest.approx(best.x[0], abs=1e-6)


def test_where_the_input_acts_at_once_the_plans_past_is_that_of_its_inputs():
    model = NarxModel(
        tuple(map(Term.parse, ("1", "y(t-1)", "u(t)", "u(t)^2"))),
        np.array([0.0, 0.5, 0.5, 0.2]),
        Scaling(0.0, 1.0, 0.0, 1.0),
    )
    plan = inverse(model, smoothness=1e-3, lowest=-1.0, highest=2.0, rate=1e3)
    wanted = np.repeat([0.3, 1.1, 0.6, 0.9], 20)
    ahead = np.concatenate([wanted, np.full(12, wanted[-1])])
    plan.rest(0.0, 0.0)
    y, errors = 0.0, []
    for k in range(wanted.size):
        u = plan.step(ahead[k : k + 12])
        y = 0.5 * y + 0.5 * u + 0.2 * u**2
        assert plan.advance() == pytest.approx(y, abs=1e-12)
        errors.append(y - wanted[k])
    assert np.sqrt(np.mean(np.square(errors))) < 0.05


def test_slopes_agree_with_differences():
    rng = np.random.default_rng(1)
    lag = PLANT.max_lag
    y, u = rng.normal(size=(2, lag + 1))
    chosen = inverse()
    a, b = np.empty((2, lag + 1))
    output_and_slopes(chosen.equation, y, u, lag, a, b)
    for signal, slopes in ((y, a), (u, b)):
        for k in range(1 if signal is y else 0, lag + 1):
            ends = []
            for step in (-1e-6, 1e-6):
                signal[lag - k] += step
                args = chosen.equation, y, u, lag, np.empty(lag + 1), np.empty(lag + 1)
                ends.append(output_and_slopes(*args))
                signal[lag - k] -= step
            assert slopes[k] == pytest.approx((ends[1] - ends[0]) / 2e-6, abs=1e-7)


def test_limits_and_rate_are_kept_where_the_reference_is_out_of_reach():
    reference = np.where(np.arange(300) < 100, rest(PLANT, 1.5), rest(PLANT, 3.4) + 1.0)
    u = inverse_of(inverse(rate=5.0), reference, 2.4, rest(PLANT, 2.4))
    assert u.min() >= 1.4
    assert u.max() == pytest.approx(3.4)
    assert np.abs(np.diff(np.concatenate([[2.4], u]))).max() <= 5.0 / RATE + 1e-12


def test_at_a_limit_the_input_is_exactly_that():
    """Rounding in the units of the equation would leave some limits by the last digit."""
    for end in np.round(np.arange(0.01, 0.6, 0.01), 2).tolist():
        plan = inverse(lowest=1.4 - end, highest=3.4 + end)
        top = inverse_of(plan, np.full(12, rest(PLANT, 3.4) + 9.0), 2.4, rest(PLANT, 2.4))
        low = inverse_of(plan, np.full(12, rest(PLANT, 1.4) - 9.0), 2.4, rest(PLANT, 2.4))
        assert top.max() == 3.4 + end
        assert low.min() == 1.4 - end


@pytest.mark.parametrize("start", [3.5, 1.3, np.nan])
def test_a_rest_outside_the_limits_is_refused(start):
    """From there an input is within the limits or within the rate, and cannot be both."""
    with pytest.raises(InputError, match=r"it rests at .*from 1\.4 to 3\.4") as refused:
        inverse().rest(start, rest(PLANT, 2.4))
    assert refused.value.field == "u"
    inverse().rest(3.4, rest(PLANT, 3.4))


@pytest.mark.parametrize("wanted", [np.nan, np.inf])
def test_a_reference_that_is_no_number_is_refused_and_the_plan_stays(wanted):
    plan, ahead = inverse(), np.full(12, rest(PLANT, 2.6))
    plan.rest(2.4, rest(PLANT, 2.4))
    with pytest.raises(InputError) as refused:
        plan.step(np.where(np.arange(12) == 5, wanted, ahead))
    assert refused.value.field == "reference"
    other = inverse()
    other.rest(2.4, rest(PLANT, 2.4))
    assert plan.step(ahead) == other.step(ahead)


@pytest.mark.parametrize("reference", [np.empty(0), np.ones((3, 2)), np.array([0.5, np.nan])])
def test_a_reference_that_is_none_is_refused(reference):
    with pytest.raises(InputError) as refused:
        inverse_of(inverse(), reference, 2.4, rest(PLANT, 2.4))
    assert refused.value.field == "reference"


@pytest.mark.parametrize("samples", [11, 13])
def test_a_reference_of_another_length_than_the_horizon_is_refused(samples):
    plan = inverse()
    plan.rest(2.4, rest(PLANT, 2.4))
    with pytest.raises(InputError, match="of 12 finite numbers"):
        plan.step(np.full(samples, 0.5))


def test_a_model_that_diverges_gives_no_input():
    wild = NarxModel((Term.parse("y(t-1)"), Term.parse("u(t-1)")), np.array([9.0, 1.0]), SCALING)
    chosen = inverse(wild)
    chosen.rest(2.4, 0.9)
    assert chosen.step(np.full(12, 0.5)) is None
    with pytest.raises(InputError, match="diverges"):
        inverse_of(chosen, np.full(5, 0.5), 2.4, 0.9)


@pytest.mark.parametrize("rate", [100.0, -50.0, np.nan, 0.0])
def test_a_sampling_rate_that_is_not_the_models_is_refused(rate):
    of_50_hz = replace(PLANT, labels=Labels(sampling_rate=50.0))
    with pytest.raises(InputError, match="sampling_rate"):
        inverse(of_50_hz, sampling_rate=rate)
    own = inverse(of_50_hz, sampling_rate=None)
    for plan in (own, inverse(of_50_hz)):
        plan.rest(2.4, rest(PLANT, 2.4))
    ahead = np.full(12, rest(PLANT, 3.4) + 9.0)
    assert own.step(ahead) == plan.step(ahead) == pytest.approx(2.4 + 40.0 / 50.0)
    with pytest.raises(InputError, match="does not know its sampling rate"):
        inverse(sampling_rate=None)


@pytest.mark.parametrize(
    "change",
    [{"horizon": 2}, {"smoothness": 0.0}, {"smoothness": np.inf}, {"lowest": 4.0},
     {"lowest": -np.inf}, {"highest": np.inf}, {"rate": np.nan}],
)  # fmt: skip
def test_settings_out_of_range_are_refused(change):
    with pytest.raises(InputError):
        inverse(**change)
