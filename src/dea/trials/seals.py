"""Opening a sealed label, and proof that it is the one committed to."""

import hashlib
from pathlib import Path

from dea.errors import InputError


def open_seal(sealed: Path, committed: str) -> bytes:
    """Return the content of a sealed file whose SHA-256 was published before the diagnosis.

    Raises
    ------
    InputError
        If the file is missing or is not the one committed to.
    """
    if not sealed.exists():
        raise InputError("the sealed label is missing", file=sealed, remedy="Draw the batch again")
    content = sealed.read_bytes()
    found = hashlib.sha256(content).hexdigest()
    if found != committed:
        raise InputError(
            f"its SHA-256 is {found}, the commitment says {committed}",
            file=sealed,
            field="sha256",
            remedy="The label was changed after it was sealed: draw the batch again",
        )
    return content
