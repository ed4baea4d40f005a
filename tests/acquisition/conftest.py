"""Guardians of these tests end with them."""

import time
from pathlib import Path

import pytest

from dea.acquisition import duty


@pytest.fixture(autouse=True)
def no_guardian_is_left(duty_folder: Path):
    """Dismiss guardians whose device has gone for good."""
    yield
    for path in duty_folder.glob("dea_duty_*"):
        duty.order(path, duty.Order.DISMISS)
    deadline = time.monotonic() + 20
    while any(duty.look(path).alive for path in duty_folder.glob("dea_duty_*")):
        assert time.monotonic() < deadline, "a guardian does not end"
        time.sleep(0.02)
    for path in duty_folder.iterdir():
        path.unlink()
