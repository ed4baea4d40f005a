"""How a result was made, as HTML: its data, settings, job and code."""

import json
import os
import re
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from dea import provenance
from dea.errors import InputError

_MARKS = re.compile(r"[\\`*_~\[\]<>&|!#]")  # of Markdown and HTML, within a line


def origin(product: Path) -> str:
    """Return what the job of ``product`` says of itself, folded, with links to its files.

    Raises
    ------
    InputError
        If nothing says which job made it, or it is not what that job made.
    """
    said = _said(product)
    job, run = said["job"], said["run"]
    rows = [
        ("file", _link(str(product))),
        ("data", ", ".join(map(_link, provenance.sources(job, run))) or "none"),
        ("job", f"{escape(job['name'])}, rule {escape(job['rule'])}, {_code(said['identity'])}"),
        ("command", _code(" ".join(["python -m", *job["command"]]))),
        ("settings", f"<pre>{escape(json.dumps(job['settings'], indent=1, sort_keys=True))}</pre>"),
        ("code", f"commit {_code(run['commit'])}: {_modules(job['code'])}"),
        ("run", escape(_run(run))),
    ]
    body = "".join(f"<tr><th>{name}</th><td>{text}</td></tr>" for name, text in rows)
    return f"<details><summary>how it was made</summary><table>{body}</table></details>"


def systems(product: Path) -> set[str]:
    """Return the systems from whose datasets the job of ``product`` made it.

    Raises
    ------
    InputError
        As :func:`origin`.
    """
    return {Path(source).parent.name for source in _said(product)["job"]["inputs"]}


def _said(product: Path) -> dict[str, Any]:
    provenance.check(product, provenance.digest(product))
    return provenance.read_description(provenance.description_of(product))


def _run(run: dict[str, Any]) -> str:
    chosen = [f"{name}={value}" for name, value in run["instructions"].items()]
    return ", ".join([run["processor"], run.get("blas", "no linear algebra"), *chosen])


def _modules(code: dict[str, str]) -> str:
    """Return links to the files of code of the job; the packages are listed in a file too."""
    return ", ".join(_link(path) for path in code)


def _link(path: str) -> str:
    """Return a link that works from the folder of the results."""
    target = quote(os.path.relpath(path, provenance.RESULTS))
    return f'<a href="{target}">{escape(path)}</a>'


def _code(text: str) -> str:
    return f"<code>{escape(text)}</code>"


def verdict(system: str) -> str | None:
    """Return the sentence of a diagnosis as Markdown, ``None`` where there is none.

    Raises
    ------
    InputError
        If the file is not what its job made.
    """
    file = provenance.RESULTS / "discrepancy" / system / "verdict.json"
    if not file.exists():
        return None
    provenance.check(file, provenance.digest(file))
    sentence = json.loads(file.read_text(encoding="utf-8")).get("sentence")
    if not isinstance(sentence, str):
        raise InputError("has no sentence", file=file, remedy="Delete it and run again")
    # It holds names and units of a user's files.
    return _MARKS.sub(r"\\\g<0>", " ".join(sentence.split()))
