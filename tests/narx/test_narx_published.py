import numpy as np
import pytest

from dea.errors import InputError
from dea.excitation import design
from dea.narx import load_published
from published_plants import published_plants, smooth_input


@pytest.fixture(scope="module")
def plants():
    return published_plants()


def test_the_published_table_holds_six_models_of_ten_or_eleven_terms(plants):
    assert {name: len(model.terms) for name, model in plants.items()} == {
        "DEA1": 11,
        "DEA2": 10,
        "DEA3": 10,
        "DEA4": 10,
        "DEA5": 10,
        "DEA6": 11,
    }


def test_normalised_inputs_keep_all_six_bounded_and_raw_volts_do_not(plants):
    volts = design("gaussian", duration=40, sampling_rate=50, low=1.1, high=3.75, seed=1, band=1.0)
    assert all(np.isfinite(model.simulate(smooth_input())).all() for model in plants.values())
    diverged = [n for n, model in plants.items() if np.isinf(model.simulate(volts)[-1])]
    assert diverged == ["DEA2", "DEA3", "DEA4", "DEA5"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("models: {A: {'x(t-1)': 1}}", r"published.yaml: models.A: 'x\(t-1\)' is not a term"),
        ("models: {A: {'y(t-1)': fast}}", r"models.A.y\(t-1\): it is 'fast'. Give a number"),
        ("models: {A: {'y(t-1)': true}}", r"models.A.y\(t-1\): it is True"),
        ("models: [1, 2]", "models: it is .* Give a mapping of names"),
        ("plants: {}", "plants: unknown key 'plants'.*models"),
        ("models: {A: [", "not valid YAML"),
    ],
)
def test_a_wrong_file_is_named(tmp_path, text, message):
    path = tmp_path / "published.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        load_published(path)
