"""A clock for tests; guardians of these tests end with them."""

import time
from pathlib import Path

import pytest
from memory_link import Clock
from plain_module import PlainModule

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


@pytest.fixture
def clock(monkeypatch) -> Clock:
    """Return a clock by which laws and the way to zero go, that passes only while they sleep."""
    made = Clock()
    for room in ("laws", "zero"):
        monkeypatch.setattr(f"dea.acquisition.{room}.time", made)
    return made


@pytest.fixture
def module():
    """Return a plain module that answers until the test ends."""
    made = PlainModule()
    yield made
    made.stop()
