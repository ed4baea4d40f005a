import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from dea.acquisition.duty import duty_file
from dea.acquisition.endpoint_lock import endpoint_lock
from dea.acquisition.shared_file import open_shared
from dea.errors import InputError
from dea.modbus import read_device

DEVICE = Path(__file__).parents[2] / "config/devices/virtual_bench.yaml"
HOLD = """
import sys
from dataclasses import replace
from dea.acquisition.endpoint_lock import endpoint_lock
from dea.modbus import read_device

with endpoint_lock(replace(read_device(sys.argv[1]), port=int(sys.argv[2]))):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def device():
    return replace(read_device(DEVICE), port=45678)


@pytest.fixture
def holder(device):
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(DEVICE), str(device.port)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def test_a_device_that_another_process_drives_is_refused_with_its_number(device, holder):
    with (
        pytest.raises(InputError, match=rf"127\.0\.0\.1:45678.*process {holder.pid}"),
        endpoint_lock(device),
    ):
        pass


def test_another_name_of_the_same_place_is_refused(device, holder):
    with pytest.raises(InputError), endpoint_lock(replace(device, host="localhost")):
        pass


def test_another_unit_at_the_same_place_is_free(device, holder):
    with endpoint_lock(replace(device, unit_id=2)):
        pass


def test_the_lock_of_a_killed_process_is_free(device, holder):
    holder.kill()
    holder.wait()
    with endpoint_lock(device):
        pass


def test_the_lock_is_free_after_the_block(device):
    for _ in range(2):
        with endpoint_lock(device):
            pass


def test_users_with_other_temporary_folders_share_the_lock(device, holder, monkeypatch, tmp_path):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    with pytest.raises(InputError), endpoint_lock(device):
        pass


def test_another_user_may_open_a_shared_file_whatever_the_umask(tmp_path):
    before = os.umask(0o077)
    try:
        os.close(open_shared(tmp_path / "lock"))
    finally:
        os.umask(before)
    assert (tmp_path / "lock").stat().st_mode & 0o777 == 0o666


def test_the_guardian_of_an_output_is_found_whatever_the_temporary_folder(device, monkeypatch):
    monkeypatch.delenv("DEA_DUTY")
    before = duty_file(device)
    monkeypatch.setenv("TMPDIR", "/elsewhere")
    monkeypatch.setattr("tempfile.tempdir", None)
    assert duty_file(device) == before
    assert duty_file(replace(device, host="localhost")) == before
