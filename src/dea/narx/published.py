"""Models known from elsewhere, read from a file of their terms and coefficients."""

from pathlib import Path

import yaml

from dea.errors import InputError
from dea.narx.model import NarxModel


def load_published(path: str | Path) -> dict[str, NarxModel]:
    """Read models by name from YAML: ``models: {NAME: {"y(t-1)": 0.9, ...}}``.

    They speak of signals as the file's authors scaled them; nothing is scaled here.

    Raises
    ------
    InputError
        Naming the file and the model, for text that is no term or no number.
    """
    file = Path(path)
    try:
        listed = yaml.safe_load(file.read_text())["models"]
        tables = {str(name): dict(terms) for name, terms in listed.items()}
    except (OSError, yaml.YAMLError, KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"it holds no models ({error})",
            file=file,
            field="models",
            remedy='Write models: {NAME: {"y(t-1)": 0.9}}.',
        ) from error
    return {name: _model(terms, file, name) for name, terms in tables.items()}


def _model(terms: dict, file: Path, name: str) -> NarxModel:
    for term, value in terms.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(
                f"its coefficient is {value!r}",
                file=file,
                field=f"models.{name}.{term}",
                remedy="Coefficients are numbers.",
            )
    try:
        return NarxModel.from_terms({str(term): value for term, value in terms.items()})
    except InputError as error:
        raise InputError(
            error.problem, file=file, field=f"models.{name}", remedy=error.remedy
        ) from error
