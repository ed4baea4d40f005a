"""Faults of the host, put into a Python process from within: a slow disk and a stepped clock.

A file named by the environment says when: while it exists, ``fsync`` blocks; and a number of
seconds in it is added to the wall clock. ``sitecustomize`` applies them in every interpreter that
the command starts.
"""

import os
import time
from pathlib import Path

SLOW_SYNC, CLOCK_STEP = "FAULTS_SLOW_SYNC", "FAULTS_CLOCK_STEP"


def apply() -> None:
    """Replace the functions of the interpreter that the environment asks for."""
    if slow := os.environ.get(SLOW_SYNC):
        _slow_sync(Path(slow))
    if step := os.environ.get(CLOCK_STEP):
        _step_clock(Path(step))


def _slow_sync(while_exists: Path) -> None:
    def wrap(name: str) -> None:
        sync = getattr(os, name)

        def slow(descriptor: int) -> None:
            while while_exists.exists():
                time.sleep(0.02)
            sync(descriptor)

        setattr(os, name, slow)

    wrap("fsync")
    wrap("fdatasync")


def _step_clock(file: Path) -> None:
    wall, wall_ns = time.time, time.time_ns

    def step() -> float:
        return float(file.read_text()) if file.exists() else 0.0

    time.time = lambda: wall() + step()
    time.time_ns = lambda: wall_ns() + round(1e9 * step())
