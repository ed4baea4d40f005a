"""Guardians of these tests are known to these tests alone, and end with them."""

import os
import time
from pathlib import Path

import pytest

from dea.acquisition import duty


@pytest.fixture(scope="session", autouse=True)
def duty_folder(tmp_path_factory):
    """Keep the files and the trips of guardians out of the machine's own."""
    folder = tmp_path_factory.mktemp("duty")
    os.environ["DEA_DUTY"] = str(folder)
    os.environ["XDG_STATE_HOME"] = str(tmp_path_factory.mktemp("state"))
    return folder


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
