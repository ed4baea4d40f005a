"""Fetch the public measured records into ``data/``: ``python -m dea.public_records``."""

import argparse
import hashlib
import sys
from collections.abc import Iterable, Mapping
from http.client import HTTPException
from pathlib import Path
from urllib.request import urlopen

from dea.checksum import sha256
from dea.configuration.files import read_yaml
from dea.configuration.problems import validated
from dea.configuration.public_records import PublicRecord, PublicRecords, UntimedTable
from dea.errors import InputError
from dea.store import atomic

CATALOGUE = Path("config/public_records.yaml")


def fetch(
    names: Iterable[str] = (),
    *,
    catalogue: Path = CATALOGUE,
    destination: Path = Path("data"),
    folder: Path | None = None,
) -> list[Path]:
    """Bring the records ``names`` (all, if none is named) to ``destination``.

    Parameters
    ----------
    folder
        Copy from this folder, laid out like ``destination``, instead of the public address.

    Raises
    ------
    InputError
        If a name is unknown, an address does not answer, or the content is not the one whose
        SHA-256 the catalogue holds; nothing is left behind for that record.
    """
    content = read_yaml(catalogue, what="the catalogue", example=str(CATALOGUE))
    records = validated(PublicRecords, content, catalogue).root
    return [
        _fetch_one(name, _entry(records, name, catalogue), catalogue, destination, folder)
        for name in (list(names) or records)
    ]


def _entry(records: Mapping[str, PublicRecord], name: str, catalogue: Path) -> PublicRecord:
    if name not in records:
        raise InputError(
            f"there is no public record {name!r}",
            file=catalogue,
            remedy=f"There are {', '.join(records)}",
        )
    return records[name]


def _fetch_one(
    name: str, entry: PublicRecord, catalogue: Path, destination: Path, folder: Path | None
) -> Path:
    target = destination / name
    if target.exists() and sha256(target) == entry.sha256:
        return target
    address = (folder / name).resolve().as_uri() if folder else entry.url
    try:
        with urlopen(address, timeout=60) as answer:
            content = answer.read()
    except (OSError, HTTPException) as error:
        raise InputError(
            f"{address} does not answer, or not to the end ({getattr(error, 'reason', error)})",
            file=catalogue,
            field=name,
            remedy="Check the connection, or give a folder that holds the records with --from",
        ) from error
    if entry.sampled and not folder:
        try:
            content = _with_times(content, entry.sampled)
        except (ValueError, IndexError):
            raise InputError(
                f"{address} is no table of numbers with the columns asked for",
                file=catalogue,
                field=name,
                remedy="Check url and sampled.columns, or give a folder with --from",
            ) from None
    found = hashlib.sha256(content).hexdigest()
    if found != entry.sha256:
        raise InputError(
            f"{address} holds something else (SHA-256 {found[:12]}…)",
            file=catalogue,
            field=name,
            remedy=f"The record's SHA-256 is {entry.sha256[:12]}…; give a folder with --from",
        )
    with atomic(target) as partial:
        partial.write_bytes(content)
    return target


def _with_times(content: bytes, table: UntimedTable) -> bytes:
    """Return the columns of a table of numbers as CSV with a column ``time`` (s) before them."""
    lines = [",".join(["time", *table.columns])]
    rows = [line for line in content.decode(errors="replace").splitlines() if line.strip()]
    for index, row in enumerate(rows):
        cells = row.replace(",", " ").split()
        numbers = [float(cells[column - 1]) for column in table.columns.values()]
        lines.append(
            ",".join([f"{index * table.interval:.3f}", *(f"{number:.6f}" for number in numbers)])
        )
    return "\n".join([*lines, ""]).encode()


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="records of the catalogue; all, if none is named")
    parser.add_argument("--from", dest="folder", type=Path, help="a folder that holds them already")
    arguments = parser.parse_args()
    try:
        for path in fetch(arguments.names, folder=arguments.folder):
            print(path)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(2) from None


if __name__ == "__main__":
    main()
