"""Where tests find the public measured records."""

from pathlib import Path

import pytest

_PROJECT = Path(__file__).parents[1]
# Fetched into the project, or kept beside it for several.
_PLACES = _PROJECT / "data", _PROJECT.parent / "shared" / "data"
DATA = next((place for place in _PLACES if place.exists()), _PLACES[0])
needs_records = pytest.mark.skipif(
    not DATA.exists(), reason="no public measured records; `make records` fetches them"
)
