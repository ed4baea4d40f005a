"""Which code made a file, so that what other code made is made again."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[2]


def digest(patterns: Iterable[str], files: Iterable[Path] = ()) -> str:
    """Return a digest of the project's files that match patterns, and of other files."""
    found = hashlib.sha256()
    matching = {file for pattern in patterns for file in ROOT.glob(pattern)}
    for file in sorted(matching | set(files)):
        found.update(file.read_bytes())
    return found.hexdigest()
