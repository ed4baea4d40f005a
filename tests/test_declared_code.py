"""A job of the workflow refuses code and data of the package that its rule does not declare."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ALWAYS = [
    f"src/dea/{name}.py"
    for name in ("__init__", "compiled", "declared_code", "errors", "stages/__init__")
]
STAGE = """
from dea.stages.command import run

def probe(settings):
    {load}
    print("done")

if __name__ == "__main__":
    run(probe)
"""


@pytest.fixture
def job(tmp_path):
    """Runs a stage that executes ``load``, as a job that declares the files of ``code``."""
    shutil.copytree(
        ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
    )
    (tmp_path / "src/dea/limits.yaml").write_text("a: 1\n")

    def run(load, code, **variables):
        (tmp_path / "src/dea/stages/probe.py").write_text(STAGE.format(load=load))
        stage = [
            f"src/dea/{name}.py"
            for name in (
                "stages/probe",
                "stages/command",
                "atomic_file",
                "checksum",
                "progress",
                "provenance",
            )
        ]
        # Whatever this process was told, the job writes bytecode, which the next one reads.
        environment = {"PYTHONPATH": str(tmp_path / "src"), "PYTHONDONTWRITEBYTECODE": ""}
        declared = {} if code is None else {"DEA_CODE": " ".join([*ALWAYS, *stage, *code])}
        return subprocess.run(
            [sys.executable, "-m", "dea.stages.probe"],
            cwd=tmp_path,
            env=os.environ | environment | declared | variables,
            capture_output=True,
            text=True,
        )

    return run


LAZY = "from dea import seeds"
WAYS = [
    LAZY,
    "from ..  import seeds",
    "import importlib; importlib.import_module('dea.seeds')",
    "import dea; dea.seeds if hasattr(dea, 'seeds') else __import__('dea.seeds')",
    "import runpy; runpy.run_path('src/dea/seeds.py')",
    "try:\n        import dea.seeds\n    except Exception: pass",
    "import subprocess, sys\n"
    "    subprocess.run([sys.executable, '-c', 'import dea.seeds'], check=True)",
]


@pytest.mark.parametrize("load", WAYS)
@pytest.mark.parametrize("warm", [False, True], ids=["from source", "from bytecode"])
def test_an_undeclared_module_fails_the_job_and_is_named(job, load, warm):
    if warm:
        assert job(LAZY, None).returncode == 0
    result = job(load, [])
    assert result.returncode == 1
    assert "done" not in result.stdout
    line = next(line for line in result.stderr.splitlines() if line.startswith("error: "))
    assert line.startswith("error: src/dea/seeds.py: ")
    assert line.endswith("Add modules('dea.seeds') to the inputs `code` of the rule.")


def test_the_stage_is_named(job):
    assert "dea.stages.probe loads it" in job(LAZY, []).stderr


@pytest.mark.parametrize(
    "read",
    [
        "open('src/dea/limits.yaml')",
        "from importlib.resources import files; files('dea').joinpath('limits.yaml').read_text()",
        "from pathlib import Path; import dea; Path(dea.__file__).with_name('limits.yaml').open()",
    ],
)
def test_an_undeclared_data_file_fails_the_job_and_is_named(job, read):
    result = job(read, [])
    assert result.returncode == 1
    assert result.stderr.strip().endswith(
        "Add 'src/dea/limits.yaml' to the inputs `code` of the rule."
    )
    assert job(read, ["src/dea/limits.yaml"]).returncode == 0


@pytest.mark.parametrize(
    "code", [["src/dea/seeds.py", "src/dea/given_numbers.py"], None], ids=["declared", "no job"]
)
def test_declared_code_runs_and_so_does_a_program_that_is_no_job(job, code):
    result = job(LAZY, code)
    assert result.stdout == "done\n", result.stderr


def test_bytecode_kept_elsewhere_is_told_by_its_source(job, tmp_path):
    elsewhere = {"PYTHONPYCACHEPREFIX": str(tmp_path / "bytecode")}
    assert job(LAZY, None, **elsewhere).returncode == 0
    assert job(LAZY, [], **elsewhere).returncode == 1


def test_every_stage_of_the_workflow_is_started_so_that_it_refuses():
    for rules in sorted((ROOT / "workflow/rules").glob("*.smk")):
        assert "python -m dea" not in rules.read_text(), f"{rules} starts a stage without stage()"
