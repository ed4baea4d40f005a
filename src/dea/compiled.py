"""The folder in which numba keeps compiled functions between processes.

Numba recompiles a function when its own file changes, and not when the file of a function that it
calls changes. A folder for each state of all compiled modules therefore never holds outdated code.
"""

import os
import shutil
import sys
import time
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path

PACKAGE = Path(__file__).parent
PLACES = (PACKAGE / "__pycache__", Path("~/.cache/dea"))
VARIABLE = "NUMBA_CACHE_DIR"
PREFIX = "dea-compiled-"
UNUSED = 7 * 24 * 3600.0  # s


def keep_compiled_functions() -> None:
    """Let numba use the folder of this state of the source, unless the user has chosen one.

    Where none of the places can be written to, numba uses its default places.
    """
    config = sys.modules["numba"].core.config if "numba" in sys.modules else None
    given = config.CACHE_DIR if config else os.environ.get(VARIABLE)
    # A folder with the prefix was set by a parent process, whose source may differ from this one.
    if given and not Path(given).name.startswith(PREFIX):
        return
    folder = _writable(PREFIX + source_state(PACKAGE), PLACES)
    chosen = "" if folder is None else str(folder)
    if config:
        # After a change of the environment numba reads all settings anew and loses those of code.
        config.CACHE_DIR = chosen
    else:
        os.environ[VARIABLE] = chosen


def source_state(package: Path) -> str:
    """Return a hash of every module of ``package`` that mentions numba, and of their names."""
    state = sha256()
    for folder, folders, names in os.walk(package):
        folders[:] = sorted(set(folders) - {"__pycache__"})
        for name in sorted(names):
            source = Path(folder, name).read_bytes() if name.endswith(".py") else b""
            if b"numba" in source:
                state.update(f"{folder[len(str(package)) :]}/{name} {len(source)}\n".encode())
                state.update(source)
    return state.hexdigest()[:16]


def _writable(name: str, places: Iterable[Path]) -> Path | None:
    """Return the folder ``name`` in the first of ``places`` that can be written to, or ``None``.

    Numba makes it when it first compiles: an import makes no folder.
    """
    for place in places:
        try:
            folder = place.expanduser() / name
            if folder.exists():
                os.utime(folder)
                return folder
            there = next(parent for parent in folder.parents if parent.exists())
            if there.is_dir() and os.access(there, os.W_OK | os.X_OK):
                _remove_unused(folder.parent)
                return folder
        # RuntimeError: the user has no home directory.
        except (OSError, RuntimeError):
            continue
    return None


def _remove_unused(parent: Path) -> None:
    """Remove the folders that no process has started with for a week; none is still in use."""
    for folder in parent.glob(f"{PREFIX}*"):
        if time.time() - folder.stat().st_mtime > UNUSED:
            # Another process may be removing the same folder.
            shutil.rmtree(folder, ignore_errors=True)
