"""Audit the results: ``make audit``, or ``python -m dea.audit``.

Exits with 0 where everything is as its job made it, with 1 where something is not, with 2 where
there is no manifest to compare with. ``results/audit.md`` says it for people; what an earlier audit
wrote there is removed before anything is compared.
"""

import argparse
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from dea.atomic_file import atomic
from dea.audit import quotations
from dea.audit.manifest import PAGE, Manifest, collect
from dea.audit.page import page
from dea.audit.signature import unsigned
from dea.audit.verify import Finding, explained, notes, spoilt_by, verify
from dea.errors import InputError

SHOWN = 10  # results and sentences named on the terminal; the page names all


def main(arguments: list[str] | None = None) -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python -m dea.audit", description=__doc__)
    parser.add_argument("--sample", default="0", metavar="N", help="jobs to run again")
    parser.add_argument("--seed", metavar="N", help="of the draw; the time otherwise")
    parser.add_argument("--signers", type=Path, help="who may have signed the manifest")
    parser.add_argument("--collect", action="store_true", help="write the manifest")
    options = parser.parse_args(arguments)
    if options.collect:
        collect().write()
        return
    begun = datetime.now(UTC)
    with _disk_refuses("removed"):
        PAGE.unlink(missing_ok=True)
    try:
        sample = _whole("SAMPLE", options.sample)
        seed = int(time.time()) if options.seed is None else _whole("SEED", options.seed)
        manifest = Manifest.read()
        findings = unsigned(options.signers) if options.signers else []
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    findings += verify(manifest)
    repeated = []
    if sample and not findings:
        from dea.audit.recompute import recompute

        print(f"jobs are drawn with SEED={seed}", flush=True)
        for products, different in recompute(manifest, sample, seed):
            print(f"made again: {products}: {'differs' if different else 'the same'}", flush=True)
            repeated.append(products)
            findings += different
    # Before the page, which a full disk or one without write access refuses.
    _show(manifest, findings)
    text = page(manifest, findings, repeated, begun)
    with _disk_refuses("written"):
        with atomic(PAGE) as partial:
            partial.write_text(text, encoding="utf-8")
        print(f"see {PAGE}")
    if findings:
        raise SystemExit(1)


def _show(manifest: Manifest, findings: list[Finding]) -> None:
    """Print the first finding and what rests on it, or that there is none."""
    if not findings:
        print(
            f"{len(manifest.products)} results of {len(manifest.jobs)} jobs are what they were made"
            " as"
        )
        for note in notes(manifest):
            print(note)
        return
    first = findings[0]
    print(f"broken: {first.path}: {explained(first, manifest)}")
    resting = spoilt_by(first, manifest)
    resting += quotations.resting([first.path, *resting])
    for path in resting[:SHOWN]:
        print(f"  rests on it: {path}")
    if len(resting) > SHOWN:
        print(f"  and {len(resting) - SHOWN} more")
    if len(findings) > 1:
        print(f"{len(findings) - 1} more findings")


@contextmanager
def _disk_refuses(done: str) -> Iterator[None]:
    """Say that the page could not be ``done`` where the block fails for its disk, and go on."""
    try:
        yield
    except OSError as error:
        refused = InputError(
            f"cannot be {done} ({error.strerror})",
            file=PAGE,
            remedy="Free space or allow writing there, or go by what is printed",
        )
        print(f"error: {refused}", file=sys.stderr)


def _whole(name: str, text: str) -> int:
    """Return the number that a variable of make is.

    Raises
    ------
    InputError
        If it is no whole number of at least 0.
    """
    if not re.fullmatch(r"[0-9]{1,18}", text):
        raise InputError(f"it is {text!r}", field=name, remedy="Give a whole number of at least 0")
    return int(text)


if __name__ == "__main__":
    main()
