"""Published models, read from a file of their terms and coefficients."""

from pathlib import Path

from dea.errors import InputError
from dea.narx.model import NarxModel


def load_published(path: str | Path) -> dict[str, NarxModel]:
    """Read models by name from YAML: ``models: {NAME: {"y(t-1)": 0.9, ...}}``.

    They hold for signals as the file's authors scaled them; nothing is scaled here.

    Raises
    ------
    InputError
        Naming the file and the model, for text that is no term or no number.
    """
    # pydantic takes long to import, and most who import this package read no published model.
    from dea.configuration.files import read_yaml
    from dea.configuration.problems import validated
    from dea.configuration.published import PublishedModels

    content = read_yaml(
        path, what="the file of published models", example="config/published_models.yaml"
    )
    listed = validated(PublishedModels, content, path).models
    return {name: _model(terms, path, name) for name, terms in listed.items()}


def _model(terms: dict[str, float], file: str | Path, name: str) -> NarxModel:
    try:
        return NarxModel.from_terms(terms)
    except InputError as error:
        raise error.at(file=file, field=f"models.{name}") from error
