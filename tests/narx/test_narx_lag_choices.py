"""Which lags an output is offered, against searches written down anew."""

from types import SimpleNamespace

import numpy as np
import pytest

from dea.errors import InputError
from dea.narx import lag_choices, select_lags
from dea.narx import lags as room

SPACINGS = [1, 2, 3, 4, 6, 8, 11, 16, 23]


def autocorrelation(y):
    centred = y - y.mean()
    return np.correlate(centred, centred, "full")[y.size - 1 :]


def first_least(y):
    """The first lag of less autocorrelation than the one before and all up to half as far again."""
    sums = autocorrelation(y)
    for lag in range(1, y.size // 2 - 1):
        if sums[lag] < sums[lag - 1] and (sums[lag] <= sums[lag : int(1.5 * lag) + 2]).all():
            return lag
    return y.size // 5


def rough(samples, seed):
    rng = np.random.default_rng(seed)
    t = np.arange(samples)
    return 2.0 + np.sin(t / 7.0) + 0.4 * np.sin(t / 2.3) + 0.5 * rng.standard_normal(samples)


@pytest.mark.parametrize(
    ("quarter", "spacings"),
    [
        (15, SPACINGS[:3]),
        (40, SPACINGS[:6]),
        (80, SPACINGS[:8]),
        (111, SPACINGS[:8]),
        (120, SPACINGS),
    ],
)
def test_lags_are_apart_by_steps_of_the_root_of_two_up_to_a_fifth(quarter, spacings):
    """The square of a cosine is least after a quarter of its period."""
    y = np.cos(2 * np.pi * np.arange(40 * quarter) / (4 * quarter))
    expected = [
        (tuple(range(1, 1 + count * spacing, spacing)),) * 2
        for count in (2, 3)
        for spacing in spacings
    ]
    assert lag_choices(y) == expected


@pytest.mark.parametrize("seed", range(6))
def test_the_unit_is_the_earlier_minimum_of_an_output_and_of_its_square(seed):
    y = rough(600, seed)
    unit = min(first_least(y), first_least((y - y.mean()) ** 2))
    spacings = [each.y_lags[1] - 1 for each in lag_choices(y) if len(each.y_lags) == 2]
    assert spacings == [each for each in SPACINGS if each <= max(unit // 5, 1)]


@pytest.mark.parametrize("seed", range(6))
def test_inputs_of_an_even_model_reach_over_two_to_five_times_the_first_minimum(seed):
    y = rough(1200, seed)
    unit = first_least(y)
    reaches = [k * unit for k in (2, 3, 4, 5)]
    expected = [
        (tuple(range(1, count + 1)), lags)
        for count in (2, 3, 4)
        for reach in reaches
        for lags in (
            tuple(range(1, reach + 1)),
            tuple(range(1, reach + 1, 2)),
            tuple(range(2, reach + 1, 2)),
        )
    ]
    assert max(reaches) <= 120
    assert lag_choices(y, even_in_input=True) == expected


@pytest.mark.parametrize(("samples", "spacings"), [(380, SPACINGS[:7]), (400, SPACINGS[:8])])
def test_an_autocorrelation_that_falls_all_along_is_least_after_a_fifth(samples, spacings):
    """A fifth of which is 15 and 16 samples."""
    y = np.repeat([0.0, 1.0], samples // 2)
    choices = [each.y_lags for each in lag_choices(y)]
    assert [lags[1] - 1 for lags in choices if len(lags) == 2] == spacings


def test_an_output_that_alternates_has_its_first_minimum_at_lag_one():
    choices = lag_choices(np.tile([0.0, 1.0], 40), even_in_input=True)
    assert {each.u_lags[-1] for each in choices if each.u_lags[:2] == (1, 2)} == {2, 3, 4, 5}


@pytest.mark.parametrize("samples", [2, 3, 5, 9, 19])
def test_a_short_output_has_lags_one_and_two_alone(samples):
    y = np.random.default_rng(samples).standard_normal(samples)
    for even in (False, True):
        assert lag_choices(y, even_in_input=even) == [((1, 2), (1, 2))]


@pytest.mark.parametrize(("samples", "longest"), [(29, 2), (30, 3), (39, 3)])
def test_a_lag_may_be_a_tenth_of_the_record(samples, longest):
    y = np.random.default_rng(1).standard_normal(samples)
    choices = lag_choices(y)
    assert max(max(each.y_lags) for each in choices) == longest


def chosen(monkeypatch, models, errors, choices=None):
    """What is chosen among models, given the error of each in turn, and where their runs start."""
    made, found, starts = iter(models), iter(errors), []

    def error_of(*_, start, **__):
        starts.append(start)
        return next(found)

    monkeypatch.setattr(room, "select_terms", lambda *_, **__: next(made))
    monkeypatch.setattr(room, "held_out_error", error_of)
    u = np.random.default_rng(2).standard_normal(100)
    return select_lags(u, u, choices or [(1, 1)] * len(models), cuts=(2, 3)), starts


def model(stable):
    return SimpleNamespace(terms=(), stability=lambda: SimpleNamespace(stable=stable))


def test_unstable_models_come_last_and_errors_are_geometric_means(monkeypatch):
    models = [model(stable) for stable in (False, True, True, False)]
    errors = [0.1, 0.1, 4.0, 1.0, 1.0, 1.0, 0.05, 0.05]
    found, _ = chosen(monkeypatch, models, errors)
    assert [each.model for each in found] == [models[k] for k in (2, 1, 3, 0)]
    assert [each.error for each in found] == pytest.approx([1.0, 2.0, 0.05, 0.1])


@pytest.mark.parametrize(
    ("choices", "start"),
    [([([], [])], 0), ([(1, 1), ([2], [3])], 3), ([([5], [1]), ([], [4])], 5), ([(1, [0])], 1)],
)
def test_all_runs_start_after_the_longest_lag_of_all_models(monkeypatch, choices, start):
    models = [model(True) for _ in choices]
    _, starts = chosen(monkeypatch, models, [1.0] * 4, choices)
    assert starts == [start] * 2 * len(choices)


@pytest.mark.parametrize("nothing", ["choices", "thresholds", "cuts"])
def test_without_choices_thresholds_or_cuts_there_is_nothing_to_choose_from(nothing):
    u = np.random.default_rng(3).standard_normal(60)
    given = {"choices": [(1, 1)], "thresholds": [None], "cuts": [2]} | {nothing: []}
    with pytest.raises(InputError, match="there is nothing to choose from"):
        select_lags(u, u, **given)
