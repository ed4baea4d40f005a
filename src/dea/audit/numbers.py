"""Keep the numbers in the documents as the results have them: ``make numbers``.

``python -m dea.audit.numbers`` reads every quoted number (:mod:`dea.audit.quotations`) from its
file, keeps those of ``results/`` with the job that made them in ``docs/measured/results.json``, and
writes all into the documents. With ``--check``, as ``make check`` runs it, it writes nothing and
exits with 1 where a document says something else than what is kept, or than a result that was made
from the commit that is checked out.
"""

import argparse
import json
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dea import provenance
from dea.audit.quotations import CAMPAIGNS, documents, printed, quotations, replaced, source, value
from dea.errors import InputError

KEPT = CAMPAIGNS / "results.json"


def main(arguments: list[str] | None = None) -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python -m dea.audit.numbers", description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if amiss")
    options = parser.parse_args(arguments)
    try:
        problems = list(differences()) if options.check else refresh()
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    for problem in problems:
        print(problem, file=sys.stderr)
    if problems:
        raise SystemExit(1)


def refresh() -> list[str]:
    """Write every quoted number into its document, those of results from the results themselves.

    Returns the files of results that are not there now, whose kept values stay.
    """
    kept, missing = _kept(), Counter[Path]()
    quoted = [one.address for one in quotations() if _is_result(one.address)]
    found: dict[str, Any] = {}
    for address in sorted(set(quoted)):
        if source(address).exists():
            found[address] = {"value": value(address), **_made(source(address))}
        elif address in kept:
            found[address] = kept[address]
            missing[source(address)] += 1
        else:
            raise InputError(f"to be quoted as {address!r}", file=source(address),
                             remedy="Make it first: make study")  # fmt: skip
    CAMPAIGNS.mkdir(parents=True, exist_ok=True)
    KEPT.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    for document in documents():
        content = document.read_text(encoding="utf-8")
        new = replaced(content, lambda address: printed(address, _value(address, found)))
        if new != content:
            document.write_text(new, encoding="utf-8")
    return [f"{file} is not there; numbers kept from it: {n}" for file, n in missing.items()]


def differences() -> Iterator[str]:
    """Yield each quotation that is not what its file, or the kept value, says."""
    kept, commit = _kept(), _commit()
    for one in quotations():
        place = f"{one.document}:{one.line}"
        if _is_result(one.address) and one.address not in kept:
            yield f"{place}: {KEPT} has no {one.address!r}; run make numbers"
            continue
        expected = printed(one.address, _value(one.address, kept))
        if one.text != expected:
            yield f"{place}: says {one.text!r}, and {one.source} {expected!r}; run make numbers"
        elif _is_result(one.address) and _made(one.source).get("commit") == commit:
            made = printed(one.address, value(one.address))
            if made != one.text:
                yield f"{place}: says {one.text!r}, and {one.source} {made!r}; run make numbers"


def _is_result(address: str) -> bool:
    return source(address).is_relative_to(provenance.RESULTS)


def _value(address: str, kept: Mapping[str, Any]) -> Any:
    return kept[address]["value"] if _is_result(address) else value(address)


def _kept() -> dict[str, Any]:
    return json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}


def _made(result: Path) -> dict[str, str]:
    """Return job and commit of a result, nothing where no job says that it made it."""
    description = provenance.description_of(result)
    if not (result.exists() and description.exists()):
        return {}
    said = json.loads(description.read_text(encoding="utf-8"))
    job = f"{said['job']['name']} {said['identity']}"
    return {"job": job, "sha256": said["sha256"], "commit": said["run"]["commit"]}


def _commit() -> str:
    described = subprocess.run(
        ["git", "rev-parse", "HEAD"], capture_output=True, text=True, check=False
    )
    return described.stdout.strip()


if __name__ == "__main__":
    main()
