"""One structure for several systems, each with its own parameters."""

import numpy as np
import pytest

import dea
from dea.errors import InputError
from dea.narx import Forward, NarxModel, Refined, nmse, select_common_terms, select_terms

ONE = {"y(t-1)": 0.6, "u(t-1)": 0.4, "u(t-1)^2": 0.2}
OTHER = {"y(t-1)": 0.8, "u(t-1)": 0.1, "u(t-1)^2": -0.15}


def record(terms, seed, noise=0.01):
    rng = np.random.default_rng(seed)
    u = rng.uniform(-1, 1, 800)
    y = NarxModel.from_terms(terms).simulate(u)
    return 5.0 + 2.0 * u, 0.3 * (y + noise * y.std() * rng.standard_normal(u.size))


def test_systems_of_one_structure_share_it_and_keep_their_parameters():
    records = [record(ONE, 0), record(OTHER, 1)]
    found = select_common_terms(records, y_lags=2, u_lags=2, degree=2)
    assert found[0].terms == found[1].terms
    # Scaling moves the offsets of the signals into a constant.
    assert {str(term) for term in found[0].terms} - {"1"} == set(ONE)
    at = [str(term) for term in found[0].terms].index("y(t-1)")
    for model, terms in zip(found, (ONE, OTHER), strict=True):
        error = model.standard_errors[at]
        assert model.parameters[at] == pytest.approx(terms["y(t-1)"], abs=5 * error)
        assert model.stability().stable


def test_a_term_that_only_one_system_needs_is_in_the_common_structure():
    records = [record(ONE, 0), record(ONE | {"y(t-1)u(t-2)": 0.2}, 1)]
    found = select_common_terms(records, y_lags=2, u_lags=2, degree=2)
    own = select_terms(*records[0], y_lags=2, u_lags=2, degree=2)
    assert "y(t-1)u(t-2)" in map(str, found[0].terms)
    assert "y(t-1)u(t-2)" not in map(str, own.terms)
    u, y = records[0]
    assert nmse(y, found[0].simulate(u, y)) <= 1.05 * nmse(y, own.simulate(u, y))


def test_one_system_alone_has_the_model_of_its_own_selection():
    u, y = record(ONE, 0)
    settings = {"y_lags": 2, "u_lags": 2, "degree": 2, "search": Refined(1e-4)}
    (common,), own = select_common_terms([(u, y)], **settings), select_terms(u, y, **settings)
    assert str(common) == str(own)


def test_records_carry_their_labels_and_missing_samples_are_left_out():
    signals = [record(ONE, seed) for seed in (0, 1)]
    records = [dea.Record.of(*each, 10.0, units=("V", "mm")) for each in signals]
    settings = {"y_lags": 2, "u_lags": 2, "degree": 2, "search": Refined(1e-4)}
    found, plain = (select_common_terms(each, **settings) for each in (records, signals))
    assert list(map(str, found)) == list(map(str, plain))
    assert [model.labels.y_units for model in found] == ["mm", "mm"]
    records[0].y[500] = np.nan
    assert select_common_terms(records, **settings)[0].terms == found[0].terms


@pytest.mark.parametrize("search", ["refined", Forward()])
def test_a_common_structure_is_searched_by_refining_alone(search):
    with pytest.raises(InputError, match=r"search: .* Give dea\.narx\.Refined\(\)$"):
        select_common_terms([record(ONE, 0)], search=search)


def test_no_record_is_refused():
    with pytest.raises(InputError, match="records"):
        select_common_terms([])


def test_systems_of_unequal_short_records_share_a_structure():
    """With fewer equations than candidate terms each record is compressed to its own size."""
    rng = np.random.default_rng(4)
    plant = NarxModel.from_terms({"y(t-1)": 0.6, "u(t-1)": 0.4})
    inputs = [rng.uniform(-1.0, 1.0, samples) for samples in (60, 70)]
    found = select_common_terms([(u, plant.simulate(u)) for u in inputs])
    assert found[0].terms == found[1].terms
    assert set(plant.terms) <= set(found[0].terms)


def test_one_pair_in_place_of_a_list_of_pairs_is_refused():
    rng = np.random.default_rng(4)
    u = rng.uniform(-1.0, 1.0, 100)
    with pytest.raises(InputError, match=r"records: system 1 is ndarray\. Give a list"):
        select_common_terms((u, 0.5 * u))
