"""What the section `identification` of the config comes to in :func:`dea.select_terms`."""

import inspect
from dataclasses import fields, replace

import pytest
import xarray as xr

from dea import select_terms
from dea.configuration.identification import Identification
from dea.narx import SEARCHES, NarxModel, Refined
from dea.stages.identification import common_search, selection_arguments

SECTION = {
    "start": 0.0, "length": 10.0, "y_lags": 2, "u_lags": [0, 2], "degree": 2,
    "even_in_input": False, "search": "refined", "threshold": 0.5, "rounds": 7, "resamples": 0,
}  # fmt: skip


def test_every_key_is_an_argument_of_the_selection_or_of_a_search_or_of_the_stage():
    assert SECTION.keys() == Identification.model_fields.keys()
    arguments = selection_arguments(SECTION)
    assert arguments.keys() <= inspect.signature(select_terms).parameters.keys()
    of_searches = {each.name for search in SEARCHES.values() for each in fields(search)}
    left = SECTION.keys() - arguments.keys() - of_searches
    assert left == {"start", "length", "resamples", "threshold"} - of_searches


@pytest.mark.parametrize("name", SEARCHES)
def test_every_search_of_the_config_is_chosen_by_its_name(name):
    search = selection_arguments(SECTION | {"search": name})["search"]
    assert type(search) is SEARCHES[name]


def test_a_threshold_is_that_of_the_search():
    refined, forward = (
        selection_arguments(SECTION | {"search": name})["search"] for name in ("refined", "forward")
    )
    assert (refined.threshold, refined.rounds) == (0.5, 7)
    assert (forward.add_threshold, forward.prune_threshold) == (0.5, 0.5)


@pytest.mark.parametrize("name", SEARCHES)
@pytest.mark.parametrize("threshold", [0.5, None])
def test_a_common_structure_is_searched_for_in_the_rounds_of_the_config(name, threshold):
    model = NarxModel.from_terms({"u(t-1)": 1.0})
    found = [model, replace(model, trace=xr.Dataset())]
    found += [replace(model, trace=xr.Dataset({"threshold": each})) for each in (1e-4, 2e-4, 7e-4)]
    search = common_search(SECTION | {"search": name, "threshold": threshold}, found)
    given = name == "refined" and threshold is not None
    assert search == Refined(0.5 if given else 2e-4, 7)
    assert common_search(SECTION | {"search": name, "threshold": None}, []) == Refined(None, 7)


def test_a_search_that_is_unknown_is_refused():
    with pytest.raises(ValueError, match="exhaustive"):
        selection_arguments(SECTION | {"search": "exhaustive"})
