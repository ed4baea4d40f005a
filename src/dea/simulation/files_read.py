"""Which files of a user's the code of a simulation reads while it is loaded."""

import os
import sys
import sysconfig
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).parents[1]
# Where Python and the installed packages are, which a job lists otherwise.
_INSTALLED = [
    Path(sysconfig.get_path(name)) for name in ("stdlib", "platstdlib", "purelib", "platlib")
]
_opened: list[set[Path]] = []  # one set for each block that is watched now
_own: set[str] = set()  # modules of a user's that were imported in a block before


@contextmanager
def files_read() -> Iterator[set[Path]]:
    """Yield a set that holds, after the block, the files of a user's that it imported or opened.

    Modules count wherever they are, other files below the working folder; those of this package and
    of installed ones do not, nor does what a C library opens. Below the working folder, paths are
    relative. A module of a user's that an earlier block imported is imported anew, as it is now.
    """
    _watch()
    before = {name: sys.modules.pop(name) for name in _own & set(sys.modules)}
    imported, here = set(sys.modules), Path.cwd()
    opened, found = set[Path](), set[Path]()
    _opened.append(opened)
    try:
        yield found
    finally:
        # Sets that hold the same are equal.
        _opened[:] = [other for other in _opened if other is not opened]
        loaded = {
            name: Path(os.path.abspath(file))
            for name, module in sys.modules.items()
            # A namespace has no file.
            if name not in imported and (file := getattr(module, "__file__", None))
        }
        for name, module in before.items():
            sys.modules.setdefault(name, module)
    _own.update(name for name, file in loaded.items() if _is_own(file))
    for file in (*loaded.values(), *(file for file in opened if file.is_relative_to(here))):
        if _is_own(file):
            found.add(file.relative_to(here) if file.is_relative_to(here) else file)


def _is_own(file: Path) -> bool:
    """Return whether a file is a user's."""
    cached = "__pycache__" in file.parts
    known = any(map(file.is_relative_to, (_PACKAGE, *_INSTALLED)))
    return file.is_file() and not cached and not known


@cache
def _watch() -> None:
    """Collect what is opened from now on where a block is watched: Python removes no such hook."""

    def hear(event: str, arguments: tuple[Any, ...]) -> None:
        if event != "open" or not _opened:
            return
        name, _, flags = arguments
        reading = not flags & (os.O_WRONLY | os.O_RDWR)
        # A file descriptor is a number: its file was seen by name when it was opened.
        if reading and isinstance(name, str | bytes | os.PathLike):
            file = Path(os.path.abspath(os.fsdecode(name)))
            for opened in _opened:
                opened.add(file)

    sys.addaudithook(hear)
