"""Compiled functions are kept between processes and never outlive the source they came from."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

import dea
from dea.compiled import PREFIX, UNUSED, VARIABLE, source_state

SOURCE = Path(dea.__file__).parent
CALLEE = "from numba import njit\n\n@njit(cache=True)\ndef slope(x):\n    return 2.0 * x\n"
CALLER = (
    "from numba import njit\nfrom dea.callee import slope\n\n"
    "@njit('float64(float64)', cache=True)\ndef line(x):\n    return 1.0 + slope(x)\n"
)
RUN = "from dea.caller import line; print(line(10.0), sum(line.stats.cache_hits.values()))"


@pytest.fixture
def package(tmp_path):
    """The package's entrance, with one compiled function that calls another's file."""
    folder = tmp_path / "dea"
    folder.mkdir()
    for name in ("__init__.py", "compiled.py", "declared_code.py"):
        shutil.copy(SOURCE / name, folder)
    (folder / "callee.py").write_text(CALLEE)
    (folder / "caller.py").write_text(CALLER)
    return folder


def run(package: Path, command: str = RUN, **environment: str) -> list[str]:
    # What this process was told stays in the environment, as it would for any child of a session.
    given = os.environ | {"PYTHONPATH": str(package.parent)} | environment
    done = subprocess.run(
        [sys.executable, "-c", command], env=given, capture_output=True, text=True, check=True
    )
    return done.stdout.split()


@pytest.mark.slow
@pytest.mark.parametrize("first", ["", "import numba; "])
def test_an_edited_callee_is_compiled_again_and_an_unedited_one_is_not(package, first):
    assert run(package, first + RUN) == ["21.0", "0"]
    assert run(package, first + RUN) == ["21.0", "1"]
    (package / "callee.py").write_text(CALLEE.replace("2.0", "3.0"))
    assert run(package, first + RUN) == ["31.0", "0"]


def test_a_folder_of_the_user_is_used(package, tmp_path):
    run(package, **{VARIABLE: str(tmp_path / "mine")})
    assert list((tmp_path / "mine").rglob("*.nbi"))
    assert not list(package.glob(f"__pycache__/{PREFIX}*"))


def test_where_the_package_cannot_be_written_the_home_is_used(package, tmp_path):
    (package / "__pycache__").write_text("")  # no folder can be made here, by root neither
    run(package, HOME=str(tmp_path))
    assert list((tmp_path / ".cache" / "dea").rglob("*.nbi"))


def test_an_import_makes_no_folder(package):
    before = set(package.parent.rglob("*"))
    run(package, "import dea", PYTHONDONTWRITEBYTECODE="1")
    assert set(package.parent.rglob("*")) == before


def test_folders_unused_for_long_are_removed_and_recent_ones_are_not(package):
    old, recent = (package / "__pycache__" / f"{PREFIX}{name}" for name in ("old", "recent"))
    old.mkdir(parents=True)
    recent.mkdir()
    os.utime(old, (time.time() - 2 * UNUSED,) * 2)
    run(package, "import dea")
    assert recent.exists()
    assert not old.exists()


def test_the_state_is_that_of_the_compiled_modules(package):
    before = source_state(package)
    (package / "plain.py").write_text("x = 1\n")
    assert source_state(package) == before
    (package / "callee.py").rename(package / "other.py")
    assert source_state(package) != before
