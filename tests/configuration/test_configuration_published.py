"""Published models and errors, and public records, are checked like the config."""

from pathlib import Path

import pytest
import yaml

from dea.configuration.problems import validated
from dea.configuration.public_records import PublicRecords
from dea.configuration.published import PublishedErrors, PublishedModels
from dea.errors import InputError

CONFIG = Path(__file__).parents[2] / "config"
SHA256 = "0" * 64


@pytest.mark.parametrize(
    ("model", "name"),
    [
        (PublishedErrors, "published_errors"),
        (PublishedModels, "published_models"),
        (PublicRecords, "public_records"),
    ],
)
def test_the_files_of_the_study_are_good(model, name):
    content = yaml.safe_load((CONFIG / f"{name}.yaml").read_text())
    assert validated(model, content).model_dump(exclude_unset=True) == content


@pytest.mark.parametrize(
    ("model", "content", "field", "words"),
    [
        (PublishedErrors, {"errors": {"a": {"b": {"rmse": -1, "units": "V"}}}, "extensions": {}},
         "errors.a.b.rmse", "at least 0"),
        (PublishedErrors, {"errors": {"a": {"b": {"rms": 1, "units": "V"}}}, "extensions": {}},
         "errors.a.b.rms", "Did you mean 'rmse'?"),
        (PublishedErrors, {"errors": {}}, "extensions", "missing"),
        (PublishedErrors, {"errors": {}, "extensions": {"a": {"b": {"before": 1}}}},
         "extensions.a.b", "before, after and units"),
        (PublishedErrors, {"errors": {}, "extensions": {"a": {"b": {"effect": "creep"}}}},
         "extensions.a.b.effect", "Give none"),
        (PublishedModels, {"models": {"A": {"u(t-1)": float("nan")}}}, "models.A.u(t-1)", "number"),
        (PublicRecords, {"a.csv": {"url": "file:///a", "sha256": "short"}}, "a.csv.sha256",
         "64 hexadecimal"),
        (PublicRecords, {"a.csv": {"sha256": SHA256}}, "a.csv.url", "missing"),
        (PublicRecords, {"a.csv": {"ulr": "file:///a", "sha256": SHA256}}, "a.csv.ulr",
         "Did you mean 'url'?"),
        (PublicRecords, ["a.csv"], None, "mapping"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(model, content, field, words):
    with pytest.raises(InputError) as caught:
        validated(model, content, "file.yaml")
    said = str(caught.value)
    assert caught.value.field is None if field is None else caught.value.field.startswith(field)
    assert words in said
    assert "\n" not in said


def test_the_constant_term_may_be_a_number():
    found = validated(PublishedModels, {"models": {"A": {1: 0.5, "y(t-1)": 0.9}}})
    assert found.models["A"] == {"1": 0.5, "y(t-1)": 0.9}
