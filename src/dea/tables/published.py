"""Results that others have published, set beside the study's."""

from collections.abc import Mapping
from typing import Any

from dea.errors import InputError
from dea.store import Sources


def published_errors(sources: Sources) -> dict[str, Any]:
    """Return the content of ``published_errors.yaml``, checked.

    Raises
    ------
    InputError
        Naming the key that is wrong.
    """
    # pydantic takes long to import, and most tables set nothing published beside their numbers.
    from dea.configuration.problems import validated
    from dea.configuration.published import PublishedErrors

    content = sources.document("published_errors")
    checked = validated(PublishedErrors, content, "config/published_errors.yaml")
    return checked.model_dump(exclude_unset=True)


def check_units(entry: Mapping[str, Any], units: str, field: str) -> None:
    """Raise an InputError for ``field`` unless a published error is in the record's units."""
    if entry["units"] != units:
        raise InputError(
            f"it is in {entry['units']!r}, the record in {units!r}",
            field=f"{field}.units",
            remedy="Give the published error in the units of the record",
        )
