import numpy as np
import pytest

from dea.gfrf import score_recovery
from dea.narx import NarxModel
from published_plants import published_plants, smooth_input


@pytest.fixture(scope="module")
def plants():
    return published_plants()


def test_a_plant_recovers_itself(plants):
    for plant in plants.values():
        score = score_recovery(plant, plant, smooth_input(), 50, 1.0)
        assert score == {
            "nmse": 0.0,
            "h1_error": 0.0,
            "h2_error": 0.0,
            "terms_common": len(plant.terms),
            "terms_foreign": 0,
        }


def test_errors_of_the_responses_are_relative(plants):
    linear = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.0, "u(t-1)^2": 0.2})
    louder = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.1, "u(t-1)^2": 0.3, "u(t-2)": 0.0})
    score = score_recovery(linear, louder, smooth_input(), 50, 1.0)
    assert score["h1_error"] == pytest.approx(0.1)
    assert score["h2_error"] == pytest.approx(0.5)
    assert (score["terms_common"], score["terms_foreign"]) == (3, 1)


def test_a_model_without_a_rest_is_infinitely_wrong(plants):
    bursting = NarxModel.from_terms({"1": 1.0, "y(t-1)": 1.2, "y(t-1)^2": 0.5, "u(t-1)": 1.0})
    score = score_recovery(plants["DEA2"], bursting, smooth_input(), 50, 1.0)
    assert score["nmse"] == score["h1_error"] == score["h2_error"] == np.inf


def test_a_linear_plant_that_is_recovered_has_no_error_of_second_order():
    linear = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.0})
    assert score_recovery(linear, linear, smooth_input(), 50, 1.0)["h2_error"] == 0.0
    bent = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.0, "u(t-1)^2": 0.2})
    assert score_recovery(linear, bent, smooth_input(), 50, 1.0)["h2_error"] == np.inf
