"""Results that others have published, set beside the study's."""

from collections.abc import Mapping
from typing import Any

from dea.errors import InputError


def check_units(entry: Mapping[str, Any], units: str, field: str) -> None:
    """Raise an InputError for ``field`` unless a published error is in the record's units."""
    if entry["units"] != units:
        raise InputError(
            f"it is in {entry['units']!r}, the record in {units!r}",
            field=f"{field}.units",
            remedy="Give the published error in the units of the record",
        )
