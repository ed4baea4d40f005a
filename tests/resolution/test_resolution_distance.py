"""The distance of two explanations against fits by another optimiser, and what designs reach."""

from dataclasses import replace

import numpy as np
import pytest
from made_devices import INTERVAL, LIMITS
from scipy.optimize import minimize

from dea.discrepancy import Samples
from dea.excitation import KINDS
from dea.resolution.design import Design, Forms, Question, designed, fixed_forms
from dea.resolution.distance import expected, nested, squared_distance
from dea.resolution.error import Error
from dea.resolution.explanation import Explanation
from dea.resolution.law_error import LawError, Motion
from dea.simulation import catalogue, measured_scales, prepared
from made_carriage import CARRIAGE

ERROR = Error(4e-3, 6e-3, 25.0, 25.0)
AS_SEEN = LawError(ERROR, Motion(np.inf, np.inf), 0.0)


def explanation(effect, law, spread=0.02):
    """Return the carriage with an effect, whose coordinates are known to this spread."""
    u = np.repeat([-1.0, 1.0, 0.5, -0.2], 250)
    extended = prepared(CARRIAGE, u, INTERVAL, 1e-5)
    values = extended.layout.prior_means
    if effect is None:
        whole = extended
    else:
        record = Samples(u, u, INTERVAL)
        whole = extended.attach(catalogue()[effect], measured_scales(extended, values, record))
        rest = whole.layout.prior_means[values.size + len(law) :]
        values = np.concatenate([values, law, rest])
    own = whole.layout.own_of_records
    deviation = np.where(own, 1.0, spread)
    return Explanation(whole, whole.layout.coordinates(values), np.diag(deviation))


def distance(truth, rival, u, error=ERROR):
    views = [expected(*each.linearised(u, INTERVAL), each.root, error) for each in (truth, rival)]
    return squared_distance(*views)


def refitted(truth, rival, u):
    """Return what a search without derivatives leaves of the difference, with the belief's cost."""
    goal = truth.simulated(u, INTERVAL)
    deviation = rival.deviations

    def cost(step):
        x = rival.mean + deviation * step
        left = goal - rival.extended.simulate(rival.extended.layout.values(x), u, INTERVAL)
        whitened = ERROR.whitened(left)
        return whitened @ whitened + step @ step

    best, start = np.inf, np.zeros(deviation.size)
    for _ in range(4):
        found = minimize(cost, start, method="Powell", options={"xtol": 1e-6, "ftol": 1e-10})
        if found.fun > best - 1e-6:
            break
        best, start = found.fun, found.x
    return best


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_distance_is_what_a_nonlinear_refit_leaves(seed):
    u = np.repeat(np.random.default_rng(seed).uniform(-1.0, 1.0, 12), 25)
    lag, late = explanation("sensor_lag", [0.06, 0.9, 0.0]), explanation("transport_delay", [0.05])
    for truth, rival in ((lag, late), (late, lag)):
        assert distance(truth, rival, u) == pytest.approx(refitted(truth, rival, u), rel=0.1)


def test_distance_of_an_explanation_to_itself_is_zero_and_grows_with_what_is_known():
    u = np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 12), 25)
    lag, late = explanation("sensor_lag", [0.06, 0.9, 0.0]), explanation("transport_delay", [0.05])
    assert distance(lag, lag, u) == 0.0
    surer = replace(late, root=1e-2 * late.root)
    assert distance(lag, surer, u) > distance(lag, late, u) > 0.0
    assert nested(lag, explanation(None, []))
    assert not nested(lag, late)


@pytest.mark.slow
def test_a_design_is_at_least_as_good_as_every_fixed_form_and_decides_sooner():
    lag, late = explanation("sensor_lag", [0.06, 0.9, 0.0]), explanation("transport_delay", [0.05])
    question = Question(
        [lag, late], [0.5, 0.5], explanation(None, []), AS_SEEN, LIMITS, 0.0
    )  # fmt: skip
    found = designed(question, (6.0, 6.0), 1e-300, np.random.default_rng(5))
    others = [question.judged(u, kind) for kind, u in fixed_forms(6.0, LIMITS, 8)]
    assert found.log_bound < min(other.log_bound for other in others)
    assert set(found.closest) == {"sensor_lag", "transport_delay"}
    fixed = designed(question, (6.0, 6.0), 1e-300, np.random.default_rng(5), Forms.FIXED)
    assert fixed.form in KINDS
    drawn = designed(question, (6.0, 6.0), 1e-300, np.random.default_rng(5), Forms.RANDOM)
    assert found.log_bound < min(fixed.log_bound, drawn.log_bound)
    short = designed(question, (1.0, 12.0), 0.4, np.random.default_rng(5))
    assert short.u.size == 150


@pytest.mark.usefixtures("few_excitations")
def test_no_predicted_output_leaves_its_range():
    lag, late = explanation("sensor_lag", [0.06, 0.9, 0.0]), explanation("transport_delay", [0.05])
    tight = replace(LIMITS, output_low=-0.5, output_high=0.5)
    question = Question([lag, late], [0.5, 0.5], explanation(None, []), AS_SEEN, tight, 0.0)
    found = designed(question, (1.0, 6.0), 0.4, np.random.default_rng(6))
    for each in (lag, late):
        assert tight.holds(each.simulated(found.u, INTERVAL))
    impossible = replace(tight, output_low=5.0, output_high=6.0)
    nowhere = replace(question, limits=impossible)
    assert designed(nowhere, (1.0, 6.0), 0.4, np.random.default_rng(6)) is None


def test_an_explanation_without_probability_changes_no_judgement():
    lag, late = explanation("sensor_lag", [0.06, 0.9, 0.0]), explanation("transport_delay", [0.05])
    other = explanation("electrode_lag", [0.04])
    three = Question([lag, late, other], [0.5, 0.5, 0.0], explanation(None, []), AS_SEEN, LIMITS, 0)
    two = replace(three, explanations=[lag, late], probabilities=[0.5, 0.5])
    u = np.repeat(np.random.default_rng(7).uniform(-1.0, 1.0, 12), 25)
    assert three.judged(u, "free").log_bound == pytest.approx(two.judged(u, "free").log_bound)
    assert set(three.judged(u, "free").closest) == {"sensor_lag", "transport_delay"}


def test_what_is_left_is_told_apart_from_each_of_the_others():
    """Two that were rejected may be close; that is settled."""
    each = [explanation(*law) for law in (
        ("sensor_lag", [0.06, 0.9, 0.0]), ("transport_delay", [0.05]), ("electrode_lag", [0.04]),
    )]  # fmt: skip
    every = Question(each, [1 / 3] * 3, explanation(None, []), AS_SEEN, LIMITS, 0.0)
    assert len(every.pairs) == 3
    assert sorted(replace(every, tested="sensor_lag").pairs) == [(0, 1), (0, 2)]


def test_a_longer_excitation_that_is_worse_replaces_none(monkeypatch):
    """Fewer of a longer duration are tried."""
    bounds = iter([-2.0, -1.5, -1.0])

    def found(_, duration, *__):
        return Design(np.zeros(round(duration)), next(bounds), ("a", "b"), 4.0, "free")

    monkeypatch.setattr("dea.resolution.design._of_duration", found)
    chosen = designed(None, (10.0, 120.0), 0.01, np.random.default_rng(0))
    assert (chosen.log_bound, next(bounds, None)) == (-2.0, None)


@pytest.mark.parametrize("duration", [21.3, 73.3, 81.1, 100.6])
def test_fixed_forms_are_made_for_a_device_that_is_sampled_slowly(duration):
    slow = replace(LIMITS, sampling_rate=1.0)
    sizes = {u.size for _, u in fixed_forms(duration, slow, 1)}
    assert sizes == {round(duration)}
