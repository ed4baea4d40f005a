"""The structures that a search keeps, and what they cost."""

from itertools import combinations

import numpy as np
import pytest

from dea.narx import NarxModel, linear_terms, regressor_matrix
from dea.narx.candidate_models import CandidateModels
from dea.narx.descent import _held_out, relative_sizes
from dea.narx.exchange import Exchange, FittedStructure, JointFit, System
from dea.narx.trace import Trace
from dea.terms import Term

CANDIDATES = linear_terms(2, 2)
PRICE = 1e-3


def system(seed):
    """Return a system with its models and its record."""
    rng = np.random.default_rng(seed)
    u = rng.uniform(-1.0, 1.0, 200)
    model = NarxModel.from_terms({"y(t-1)": 0.6, "u(t-1)": 0.4 * seed, "u(t-2)": -0.2})
    y = model.simulate(u) + 0.02 * rng.standard_normal(200)
    models = CandidateModels(CANDIDATES, [(u, y)])
    return System([(u, y)], models.power, relative_sizes(models.triangle)), models, u, y


def test_structures_come_by_cost_and_none_is_larger_than_allowed():
    one, models, *_ = system(1)
    exchange = Exchange(CANDIDATES, [one])
    for size in (1, 2, 3):
        for subset in combinations(range(len(CANDIDATES)), size):
            exchange.fit(subset, [models([subset])[0].parameters])
    kept = list(exchange.by_cost(PRICE, 2))
    assert {len(each.subset) for each in kept} == {1, 2}
    costs = [exchange.cost(each, PRICE) for each in kept]
    assert np.isfinite(costs).all()
    assert costs == sorted(costs)


def test_a_term_has_its_price_and_one_that_others_cancel_costs_more():
    """Error + price sum(1 + log2(max(1, size/4))), sizes averaged over the systems."""
    systems = [system(1), system(2)]
    subset, theta = (1, 2, 3), [np.array([9.0, -2.0, 0.5]), np.array([5.0, -0.1, 30.0])]
    sizes = np.mean(
        [
            np.sqrt(np.mean((regressor_matrix(CANDIDATES, u, y, 2)[:, subset] * each) ** 2, axis=0))
            / np.sqrt(np.mean(y[2:] ** 2))
            for each, (_, _, u, y) in zip(theta, systems, strict=True)
        ],
        axis=0,
    )
    assert (sizes > 4.0).sum() == 2
    expected = 0.3 + PRICE * (3 + np.log2(np.maximum(sizes / 4.0, 1.0)).sum())
    exchange = Exchange(CANDIDATES, [each[0] for each in systems])
    found = exchange.cost(FittedStructure(subset, JointFit(tuple(theta), 0.3)), PRICE)
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("first", range(len(CANDIDATES)))
def test_a_search_takes_as_many_steps_as_it_may_and_ends_at_the_least_cost(first):
    """Each step changes one term, or exchanges one for another, and lowers the cost."""
    one, models, *_ = system(1)
    exchange = Exchange(CANDIDATES, [one])

    def fitted(*subset):
        return FittedStructure(subset, exchange.fit(subset, [models([subset])[0].parameters]))

    subsets = [each for n in range(1, 6) for each in combinations(range(5), n)]
    least = min((fitted(*each) for each in subsets), key=lambda each: exchange.cost(each, PRICE))
    now, found, steps = fitted(first), None, 0
    while steps < 10:
        trace = Trace()
        found, taken = exchange.search(fitted(first), PRICE, steps + 1, 5, trace)
        rows = trace.to_dataset()
        accepted = ~rows.trial_status.isin(["rejected", "unstable"])
        np.testing.assert_array_equal(rows.trial_step[accepted], np.arange(taken) + 1)
        if taken == steps:
            assert rows.trial_step.max() == steps + 1
            break
        steps += 1
        assert taken == steps
        assert len(set(found.subset) ^ set(now.subset)) in (1, 2)
        assert exchange.cost(found, PRICE) < exchange.cost(now, PRICE)
        last = rows.isel(trial=accepted).isel(trial=-1)
        assert last.trial_msse == pytest.approx(found.fit.error * one.power)
        assert last.trial_serr == pytest.approx(now.fit.error - found.fit.error)
        now = found
    assert steps >= 2
    assert found.subset == least.subset


def test_without_rounds_nothing_is_tried():
    one, models, *_ = system(1)
    exchange, trace = Exchange(CANDIDATES, [one]), Trace()
    start = FittedStructure((0,), exchange.fit((0,), [models([(0,)])[0].parameters]))
    assert exchange.search(start, PRICE, 0, 5, trace) == (start, 0)
    assert trace.to_dataset().sizes["trial"] == 0


@pytest.mark.parametrize("systems", [1, 3])
@pytest.mark.parametrize("samples", [60, 400])
def test_where_runs_are_linear_in_the_parameters_a_move_s_prediction_is_its_error(samples, systems):
    terms = tuple(Term.parse(f"u(t-{lag})") for lag in (1, 2, 3, 4, 5))
    records, powers, searched = [], [], []
    for seed in range(systems):
        rng = np.random.default_rng(3 + seed)
        u = rng.standard_normal(samples)
        y = (1.0 + seed) * np.convolve(u, [0.0, 1.0, 0.7, -0.4, 0.3, 0.1])[:samples]
        y += 0.2 * rng.standard_normal(samples)
        models = CandidateModels(terms, [(u, y)])
        records.append((u, y))
        powers.append(models.power)
        searched.append(System([(u, y)], models.power, relative_sizes(models.triangle)))
    exchange = Exchange(terms, searched)

    def least_squares(*subset):
        # A run is scored from the largest lag of its terms on; systems count alike.
        start = subset[-1] + 1
        found, errors = [], []
        for (u, y), power in zip(records, powers, strict=True):
            columns = regressor_matrix(terms, u, y, start)[:, subset]
            found.append(np.linalg.lstsq(columns, y[start:], rcond=None)[0])
            errors.append(np.mean((y[start:] - columns @ found[-1]) ** 2) / power)
        return FittedStructure(subset, JointFit(tuple(found), float(np.mean(errors))))

    now = least_squares(0, 1, 4)
    moves = [*exchange._additions(now), *exchange._removals(now, "")]
    predicted = {move.subset: move.predicted for move in moves}
    # Without its largest lag, of which the prediction does not know, a run is scored from earlier.
    assert predicted.keys() - {(0, 1)} == {(0, 1, 2, 4), (0, 1, 3, 4), (0, 4), (1, 4)}
    for subset in predicted.keys() - {(0, 1)}:
        error = least_squares(*subset).fit.error
        assert abs(error - now.fit.error) > 0.01
        assert predicted[subset] == pytest.approx(error, rel=1e-6)


def test_what_is_left_out_counts_by_the_share_of_each_system_that_is_not_predicted():
    """Of one system none is predicted, of the other half of the output, so a quarter is left."""
    rng = np.random.default_rng(4)
    left_out = []
    for scale in (1.0, 30.0):
        u = rng.standard_normal(300)
        left_out.append([(u, scale * np.concatenate([[0.0], u[:-1]]))])
    candidates = Term.parse("y(t-1)"), Term.parse("u(t-1)")
    found = JointFit((np.zeros(1), np.array([15.0])), 0.0)
    fold = [([], segments) for segments in left_out]
    share = _held_out(candidates, FittedStructure((1,), found), fold)
    assert share == pytest.approx((1.0 + 0.25) / 2.0, rel=1e-9)
