"""Which files are forced to the disk, and when."""

import os
from pathlib import Path


def note_synced(monkeypatch, done):
    """Add to `done` the name of each file and folder as it is forced to the disk."""
    sync = os.fsync

    def noted(handle):
        done.append(Path(os.readlink(f"/proc/self/fd/{handle}")).name)
        sync(handle)

    monkeypatch.setattr("os.fsync", noted)
