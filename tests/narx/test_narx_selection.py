from itertools import combinations

import numpy as np
import pytest
import xarray as xr
from narx_strategies import slow_simulation

from dea.errors import InputError
from dea.narx import (
    Forward,
    NarxModel,
    Orthogonal,
    Refined,
    Scaling,
    candidate_terms,
    linear_terms,
    regressor_matrix,
    select_terms,
)
from dea.narx.candidate_models import CandidateModels
from dea.narx.forward import forward_and_prune
from dea.narx.trace import Trace
from dea.terms import Term

# DEA2's column of Table 1 of the reference study.
DEA2 = {
    "1": 0.0242,
    "y(t-1)": 1.2128,
    "y(t-2)": -0.3024,
    "u(t-1)": 0.1057,
    "u(t-2)": -0.0513,
    "u(t-3)": -0.0360,
    "y(t-1)u(t-1)^2": 0.2712,
    "y(t-1)u(t-2)u(t-3)": -0.1900,
    "y(t-1)u(t-3)^2": 0.0254,
    "y(t-2)u(t-1)^2": -0.0459,
}
SMALL = {"1": 0.1, "y(t-1)": 0.6, "u(t-1)": 0.4, "u(t-2)^2": 0.3, "y(t-1)u(t-1)": -0.2}


def record(terms, samples=1500, noise=0.0, seed=0, spread=0.6):
    rng = np.random.default_rng(seed)
    model = NarxModel.from_terms(terms)
    u = rng.uniform(-spread, spread, samples)
    y = model.simulate(u)
    return model, u, y + noise * y.std() * rng.standard_normal(samples)


def slow_candidate(candidates, subset, u, y, start):
    """A candidate by textbook least squares and term-by-term simulation."""
    terms = [candidates[j] for j in subset]
    matrix = regressor_matrix(terms, u, y, start)
    theta = np.linalg.lstsq(matrix, y[start:], rcond=None)[0]
    run = slow_simulation(terms, np.tile(theta, (u.size, 1)), u, y, start)
    return np.mean((run[start:] - y[start:]) ** 2), theta


def test_candidates_equal_textbook_estimates_and_simulations():
    _, u, y = record(SMALL, 300, noise=0.05)
    candidates = candidate_terms(2, 2, 3)
    models = CandidateModels(candidates, [(u, y)])
    rng = np.random.default_rng(3)
    # Terms of degree one and inputs alone: no free run of these diverges.
    tame = [j for j, term in enumerate(candidates) if term.degree < 2 or not term.y_lags]
    subsets = [tuple(sorted(rng.choice(tame, size, replace=False))) for size in (1, 3, 6, 9)]
    subsets.append(tuple(candidates.index(term) for term in NarxModel.from_terms(SMALL).terms))
    for subset, outcome in zip(subsets, models(subsets), strict=True):
        error, theta = slow_candidate(candidates, subset, u, y, 2)
        np.testing.assert_allclose(outcome.parameters, theta, rtol=1e-8)
        assert outcome.msse == pytest.approx(error, rel=1e-8)


def test_candidates_on_two_records_share_their_parameters():
    _, u, y = record(SMALL, 300, noise=0.05)
    candidates = linear_terms(2, 2)
    both = CandidateModels(candidates, [(u[:100], y[:100]), (u[100:], y[100:])])
    theta = both([(0, 1, 2, 3, 4)])[0].parameters
    matrix = np.vstack(
        [regressor_matrix(candidates, u[part], y[part]) for part in (slice(100), slice(100, None))]
    )
    target = np.concatenate([y[2:100], y[102:]])
    np.testing.assert_allclose(theta, np.linalg.lstsq(matrix, target, rcond=None)[0], rtol=1e-9)


def test_a_dependent_regressor_gets_no_weight():
    u = np.tile([1.0, -1.0], 100)  # u(t-2) = -u(t-1), u^2 = 1
    y = np.concatenate([[0.0], 0.5 * u[:-1]])
    y[1:] += 0.1 * np.sin(np.arange(199))
    candidates = linear_terms(1, 2)
    outcome = CandidateModels(candidates, [(u, y)])([(0, 2, 3)])[0]
    assert np.count_nonzero(outcome.parameters) == 2
    assert np.isfinite(outcome.msse)


def test_greedy_steps_take_the_largest_reduction_of_the_simulated_error():
    _, u, y = record(SMALL, 300, noise=0.02)
    candidates = candidate_terms(1, 2, 2)
    trace = Trace()
    forward_and_prune(CandidateModels(candidates, [(u, y)]), (0, 1, 2, 3), 1e-4, 1e-4, 99, trace)
    steps = trace.to_dataset().to_dataframe()
    subset = [0, 1, 2, 3]
    error = slow_candidate(candidates, subset, u, y, 2)[0]
    power = np.mean(y[2:] ** 2)
    forward = steps[steps.trial_phase == "forward"]
    assert len(forward.groupby("trial_step")) >= 2
    for _, tried in forward.groupby("trial_step"):
        free = [j for j in range(len(candidates)) if j not in subset]
        errors = [slow_candidate(candidates, sorted([*subset, j]), u, y, 2)[0] for j in free]
        np.testing.assert_allclose(tried.trial_msse, errors, rtol=1e-7)
        np.testing.assert_allclose(tried.trial_serr, (error - errors) / power, atol=1e-9)  # (5)
        best = int(np.argmin(errors))
        added = tried[tried.trial_status == "added"]
        if error - errors[best] < 1e-4 * power:
            assert added.empty
        else:
            assert list(added.trial_term) == [str(candidates[free[best]])]
            subset = sorted([*subset, free[best]])
            error = errors[best]


@pytest.mark.parametrize("threshold", [1e-4, 1e-2])
def test_pruning_removes_the_cheapest_term_while_it_costs_less_than_the_threshold(threshold):
    _, u, y = record(SMALL, 300, noise=0.05)
    candidates = candidate_terms(1, 2, 2)
    subset = list(range(len(candidates)))
    power = np.mean(y[2:] ** 2)
    error, costs = slow_candidate(candidates, subset, u, y, 2)[0], []
    while True:
        options = [[i for i in subset if i != j] for j in subset]
        errors = [slow_candidate(candidates, option, u, y, 2)[0] for option in options]
        best = int(np.argmin(errors))
        costs.append((errors[best] - error) / power)
        if costs[-1] > threshold:
            break
        subset, error = options[best], errors[best]
    # Removals that cost something were accepted: a threshold of the other sign would refuse them.
    assert max(costs[:-1]) > 0.0
    models, everything = CandidateModels(candidates, [(u, y)]), tuple(range(len(candidates)))
    found = forward_and_prune(models, everything, 1e-4, threshold, 99, Trace())
    assert found == tuple(subset)


def test_the_small_model_found_is_the_best_of_all_subsets():
    terms = {"y(t-1)": 0.5, "u(t-1)": 0.4, "u(t-1)^2": 0.3}
    _, u, y = record(terms, 200, noise=0.02)
    candidates = candidate_terms(1, 1, 2)
    found = select_terms(u, y, y_lags=1, u_lags=1, degree=2, search=Forward(), scaling=Scaling())
    size = len(found.terms)
    errors = {
        subset: slow_candidate(candidates, subset, u, y, 1)[0]
        for subset in combinations(range(len(candidates)), size)
    }
    best = min(errors, key=errors.get)
    assert set(found.terms) == {candidates[j] for j in best}


def test_dea2_driven_by_white_noise_gives_its_ten_terms_back():
    model, u, y = record(DEA2, 5000, noise=1e-3)
    found = select_terms(u, y, scaling=Scaling(), search=Refined(1e-6))
    assert set(found.terms) == set(model.terms)
    order = [found.terms.index(term) for term in model.terms]
    np.testing.assert_allclose(found.parameters[order], model.parameters, atol=2e-4)


def test_refining_never_simulates_worse_than_the_forward_selection():
    _, u, y = record(SMALL, 800, noise=0.1)
    plain, refined = (select_terms(u, y, search=each) for each in (Forward(), Refined(1e-5)))
    price = 1e-5 * np.mean(plain.scaling.normalise_output(y) ** 2)
    cost = {
        model: np.mean(((model.simulate(u, y) - y) / model.scaling.y_scale) ** 2)
        + price * len(model.terms)
        for model in (plain, refined)
    }
    assert cost[refined] <= cost[plain] * (1 + 1e-9)


def test_unstable_candidates_have_an_infinite_error_and_no_nan():
    rng = np.random.default_rng(0)
    u = rng.standard_normal(300)
    y = np.cumsum(u + 0.3 * rng.standard_normal(300))  # an integrator, on the edge
    found = select_terms(u, y, search=Forward())
    unstable = found.trace.trial_status == "unstable"
    assert unstable.any()
    assert np.isposinf(found.trace.trial_msse[unstable]).all()
    assert np.isneginf(found.trace.trial_serr[unstable]).all()
    assert not found.trace.trial_msse.isnull().any()
    assert not found.trace.trial_serr.isnull().any()


def test_the_trace_retells_the_papers_selection():
    _, u, y = record(DEA2, 1500, noise=1e-2)
    found = select_terms(u, y, search=Forward())
    linear = {str(term) for term in linear_terms(3, 3)}
    kept = set()
    trace = found.trace.to_dataframe()
    for term, status in zip(trace.trial_term, trace.trial_status, strict=True):
        if status == "added":
            kept |= linear if term == "linear basis" else {term}
        elif status == "pruned":
            kept.remove(term)
    assert kept == {str(term) for term in found.terms}


def test_the_trace_of_the_orthogonal_start_holds_the_errors_of_free_runs():
    _, u, y = record(SMALL, 300, noise=0.05)
    found = select_terms(u, y, y_lags=2, u_lags=2, degree=2)
    trace = found.trace.to_dataframe()
    steps = trace[trace.trial_phase == "orthogonal"]
    inside, outside = found.scaling.normalise_input(u), found.scaling.normalise_output(y)
    candidates = [Term.parse(name) for name in steps.trial_term]
    for k, error in enumerate(steps.trial_msse):
        expected = slow_candidate(candidates, range(k + 1), inside, outside, 2)[0]
        assert error == pytest.approx(expected, rel=1e-6)


def test_the_trace_names_the_model_selected_among_all_tried():
    _, u, y = record(DEA2, 1500, noise=1e-2)
    found = select_terms(u, y)
    trace = found.trace.to_dataframe()
    (last,) = trace[trace.trial_status == "selected"].itertuples()
    assert last.trial_term.split(", ") == [str(term) for term in found.terms]
    scaled = found.scaling.normalise_output(y), found.scaling.normalise_output(found.simulate(u, y))
    assert last.trial_msse == pytest.approx(np.mean((scaled[0] - scaled[1]) ** 2), rel=0.01)
    assert 0.0 < float(found.trace["threshold"]) < 1e-2
    assert trace.trial_phase.iloc[0] == "orthogonal"
    assert trace.trial_phase.iloc[-1] == "final"


def test_refining_passes_over_models_that_only_their_own_record_keeps_bounded():
    """Beyond 1 this plant runs away; a pulse down saves it from each pulse up that follows."""
    plant = NarxModel.from_terms({"y(t-1)": 0.9, "y(t-1)^3": 0.1, "u(t-1)": 1.0})
    u = np.zeros(1000)
    u[10::100], u[16::100] = -0.9, 1.6
    y = plant.simulate(u) + 1e-4 * np.random.default_rng(0).standard_normal(1000)
    settings = {"y_lags": 1, "u_lags": 1, "degree": 3, "scaling": Scaling()}
    plain, refined = (
        select_terms(u, y, search=each, **settings) for each in (Forward(), Refined(1e-5))
    )
    for model in (plain, refined):
        assert np.isfinite(model.simulate(u, y)).all()
    assert np.isinf(plain.simulate(u[::-1])).any()
    assert np.isfinite(refined.simulate(u[::-1])).all()


def test_no_model_exceeds_the_most_terms_asked_for():
    _, u, y = record(DEA2, 1500, noise=1e-2)
    for search in (Forward, Orthogonal, Refined):
        assert len(select_terms(u, y, search=search(max_terms=5)).terms) <= 5
        with pytest.raises(InputError, match="max_terms"):
            search(max_terms=0)


@pytest.mark.parametrize(
    ("search", "setting"),
    [
        (Orthogonal, {"max_terms": 2.5}),
        (Refined, {"rounds": 2.5}),
        (Refined, {"rounds": -1}),
        (Refined, {"threshold": "a"}),
        (Forward, {"add_threshold": np.nan}),
        (Forward, {"prune_threshold": None}),
    ],
)
def test_settings_that_are_no_numbers_of_their_kind_are_refused(search, setting):
    [(name, value)] = setting.items()
    with pytest.raises(InputError, match=f"{name}: it is {value!r}"):
        search(**setting)


def test_a_selected_model_is_stored_with_its_trace(tmp_path):
    _, u, y = record(SMALL, 400, noise=0.05)
    found = select_terms(u, y, y_lags=1, u_lags=2, degree=2)
    found.save(tmp_path / "model.nc")
    back = NarxModel.load(tmp_path / "model.nc")
    assert str(back) == str(found)
    np.testing.assert_array_equal(back.simulate(u), found.simulate(u))
    assert found.standard_errors is not None
    np.testing.assert_array_equal(back.standard_errors, found.standard_errors)
    assert found.trace.sizes["trial"] > 1
    xr.testing.assert_identical(back.trace, found.trace)


def test_selection_works_in_any_units():
    _, u, y = record(SMALL, 600, noise=0.01)
    one = select_terms(u, y, y_lags=1, u_lags=2, degree=2)
    other = select_terms(20 * u + 5, 1e-3 * y - 7, y_lags=1, u_lags=2, degree=2)
    assert set(one.terms) == set(other.terms)
    np.testing.assert_allclose(
        other.simulate(20 * u + 5), 1e-3 * one.simulate(u) - 7, rtol=0, atol=1e-8
    )


@pytest.mark.parametrize(
    ("u", "y", "message"),
    [
        (np.ones(100), np.sin(np.arange(100)), "u: it is constant"),
        (np.sin(np.arange(100)), np.ones(100), "y: it is constant"),
        (np.sin(np.arange(9)), np.cos(np.arange(9)), "leave 6 equations"),
        (np.sin(np.arange(99)), np.sin(np.arange(98)), "sampled together"),
        (np.full(50, np.nan), np.sin(np.arange(50)), "not numbers"),
        ([np.sin(np.arange(99))], [np.cos(np.arange(99))] * 2, "records of u: 1, of y: 2"),
    ],
)
def test_unusable_records_are_refused(u, y, message):
    with pytest.raises(InputError, match=message):
        select_terms(u, y)


def test_an_even_search_finds_a_rectified_systems_terms_and_no_odd_one():
    rng = np.random.default_rng(11)
    plant = NarxModel.from_terms(
        {"1": 0.1, "y(t-1)": 0.5, "y(t-1)u(t-1)u(t-2)": 0.3, "u(t-2)^2": 0.4}
    )
    u = 2.0 + rng.uniform(-2.0, 1.0, 800)  # its mean is not zero: only about zero it is even
    y = plant.simulate(u / 2.0)
    found = select_terms(u, y, y_lags=2, u_lags=2, degree=3, even_in_input=True, scaling=None)
    assert found.scaling.u_offset == 0.0
    assert all(len(term.u_lags) % 2 == 0 for term in found.terms)
    np.testing.assert_allclose(found.simulate(-u, y), found.simulate(u, y), rtol=1e-12)
    np.testing.assert_allclose(found.simulate(u, y), y, rtol=1e-6)


def test_a_record_whose_thirds_are_no_longer_than_a_lag_is_refused_in_words():
    u, y = np.random.default_rng(0).standard_normal((2, 20))
    with pytest.raises(InputError, match="no longer than the largest lag, 10"):
        select_terms(u, y, y_lags=[10], u_lags=[10], degree=1)


@pytest.mark.parametrize("search", ["forward", Forward])
def test_what_is_no_search_is_refused(search):
    u = np.sin(np.arange(200.0))
    with pytest.raises(InputError, match=r"search: .* dea\.narx\.Forward\(\)"):
        select_terms(u, 0.5 * u, search=search)
