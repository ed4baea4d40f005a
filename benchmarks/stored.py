"""Results of campaigns that the documents quote: ``docs/measured/NAME.json``.

Each says what was run, from which commit, when and where. What a campaign has found so far, from
which it goes on where it was interrupted, are lines of JSON, each with the commit that found it.
"""

import datetime
import json
import os
import platform
import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea import provenance

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "docs" / "measured"


def store(name: str, command: str, values: Mapping[str, Any], made_at: str = "") -> Path:
    """Keep what ``command`` measured; return the file.

    ``made_at`` is the commit that the program ran from, if that is not the one checked out now.
    """
    file = FOLDER / f"{name}.json"
    content = {
        "command": command,
        "commit": made_at or commit(),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "machine": {
            "processor": provenance.run_facts()["processor"],
            "cores": os.cpu_count(),
            "system": platform.system(),
            "python": platform.python_version(),
        },
        "values": values,
    }
    FOLDER.mkdir(exist_ok=True)
    file.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return file


def stored(name: str) -> dict[str, Any]:
    """Return the values that :func:`store` has kept under a name; none where there is no file."""
    file = FOLDER / f"{name}.json"
    if not file.exists():
        return {}
    values: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))["values"]
    return values


def command(target: str, **given: object) -> str:
    """Return the command that makes and keeps a campaign again: its target, and what it is given.

    What is None is left out. A list is written with blanks between.
    """
    texts = {
        name: " ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)
        for name, value in given.items()
        if value is not None
    }
    asked = (f"{name}={shlex.quote(text)}" for name, text in texts.items())
    return " ".join(["make", target, *asked, "STORE=1"])


def known(file: Path, code: str) -> list[dict[str, Any]]:
    """Return the rows of a file that the commit ``code`` has found.

    Nothing where the program has been changed since: what it was when it found them is unknown.
    """
    if code.endswith("-dirty") or not file.exists():
        return []
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return [row for row in rows if row.get("commit") == code]


def add(file: Path, row: Mapping[str, Any]) -> None:
    """Add a row, which names its commit, to a file."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps(row) + "\n")


def commit() -> str:
    """Return the commit that is checked out, ``-dirty`` where the program differs from it.

    A file that git does not know, and is not told to ignore, is such a difference, too.
    """
    head = _git("rev-parse", "HEAD").stdout.strip() or "unknown"
    changed = _git("status", "--porcelain", "--", ".", ":!docs", ":!README.md")
    return f"{head}-dirty" if changed.returncode or changed.stdout else head


def _git(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )
