import json
import os
import subprocess
import sys

import pytest

from dea.errors import DeviceError, InputError
from dea.progress import tell
from dea.stages.command import run


def noting(error, note):
    error.add_note(note)
    return error


@pytest.mark.parametrize(
    ("error", "status", "printed"),
    [
        (InputError("too short", file="a.nc", field="time", remedy="Record more"), 2,
         "error: a.nc: time: too short. Record more"),
        (InputError("too short", field="time"), 2, "error: given.nc: time: too short"),
        (DeviceError("the link is gone"), 1, "error: the link is gone"),
        (noting(DeviceError("the disk is full."), "Samples are in a.partial: recover it."), 1,
         "error: the disk is full. Samples are in a.partial: recover it."),
        (noting(InputError("no zero", remedy="Look"), "The output is at zero."), 2,
         "error: given.nc: no zero. Look. The output is at zero."),
    ],
)  # fmt: skip
def test_what_went_wrong_is_said_without_a_traceback(error, status, printed, capsys):
    def stage(settings, record):
        raise error

    with pytest.raises(SystemExit) as caught:
        run(stage, inputs=("record",), arguments=["--record", "given.nc"])
    assert caught.value.code == status
    assert capsys.readouterr().err.strip() == printed


def test_settings_and_paths_reach_the_stage(tmp_path):
    reached = {}

    def stage(settings, tests, model):
        reached.update(settings=settings, tests=[path.name for path in tests], model=model.name)

    run(
        stage,
        inputs=("tests*",),
        outputs=("model",),
        arguments=["--settings", '{"a": 1}', "--tests", "x.nc", "y.nc", "--model", "m.nc"],
    )
    assert reached == {"settings": {"a": 1}, "tests": ["x.nc", "y.nc"], "model": "m.nc"}


def test_an_error_in_the_code_is_not_hidden(capsys):
    def stage(settings):
        raise ZeroDivisionError("of a length")

    with pytest.raises(SystemExit) as caught:
        run(stage, arguments=[])
    assert caught.value.code == 1
    said = capsys.readouterr().err
    assert said.startswith("Traceback")
    assert said.endswith("ZeroDivisionError: of a length\n")


@pytest.mark.parametrize("error", ["InputError('too short')", "ValueError('too short')"])
def test_the_reason_is_on_the_terminal_where_the_logs_disk_is_full(error):
    stage = f"""
from dea.errors import InputError
from dea.progress import tell
from dea.stages.command import run
def stage(settings):
    raise {error}
run(stage, arguments=[])
"""
    with open("/dev/full", "w") as log:  # every write to it fails, as to a full disk
        ended = subprocess.run(
            [sys.executable, "-c", stage], stdout=subprocess.PIPE, stderr=log, text=True
        )
    assert ended.returncode == (2 if error.startswith("Input") else 1)
    assert "too short" in ended.stdout


def test_what_a_stage_is_doing_is_in_its_log(capsys):
    run(lambda settings: tell("pairs, 3 of 9 done"), arguments=[])
    assert capsys.readouterr().err == "step: pairs, 3 of 9 done\n"


@pytest.mark.slow
def test_linear_algebra_uses_one_thread_in_every_stage():
    """Snakemake gives the libraries of a job as many threads as its rule may have."""
    script = """
import importlib, json, sys
import threadpoolctl
importlib.import_module("dea.stages." + sys.argv[1])
import numpy, scipy.linalg
print(json.dumps([library["num_threads"] for library in threadpoolctl.threadpool_info()]))
"""
    four = {"OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "4"}
    for name in ("diagnose", "resolve", "select"):
        done = subprocess.run(
            [sys.executable, "-c", script, name], env=os.environ | four, capture_output=True,
            text=True, check=True,
        )  # fmt: skip
        threads = json.loads(done.stdout)
        assert threads
        assert set(threads) == {1}, name
