"""What a clone takes: time, memory and space of its environment and of its first study.

``python -m benchmarks.fresh_clone`` clones the commit that is checked out into a new folder. Other
programs stretch the time that passes, and hardly that of the processor.
"""

import argparse
import csv
import json
import math
import os
import resource
import subprocess
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from benchmarks.command_line import add_store, positive, run
from benchmarks.stored import ROOT, command, store
from dea.errors import InputError


def measured(program: list[str], folder: Path, environment: dict[str, str]) -> dict[str, float]:
    """Run a program; return the minutes that passed and those of the processor."""
    used, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(program, cwd=folder, env=environment, check=True)
    passed, now = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime
    return {"minutes": round(passed / 60, 2), "processor_minutes": round(processor / 60, 2)}


def megabytes(folder: Path) -> int:
    """Return the size of the files below ``folder``, as stored."""
    files = [path for path in folder.rglob("*") if path.is_file() and not path.is_symlink()]
    return round(sum(path.stat().st_blocks * 512 for path in files) / 1e6)


def largest_job(results: Path) -> int | None:
    """Return the most memory, in MB, that a job of a study had in use; None where no job tells.

    Snakemake samples it, and writes NA, - or nan for a job that ends before the first sample.
    """
    found = []
    for file in results.glob("**/benchmark/*.tsv"):
        with file.open(newline="", encoding="utf-8") as table:
            for row in csv.DictReader(table, delimiter="\t"):
                with suppress(ValueError):
                    found.append(float(row["max_rss"]))
    return max((round(each) for each in found if math.isfinite(each)), default=None)


def main(arguments: list[str] | None = None) -> None:
    """Clone, make the environment and the study, and print what it took."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fresh_clone", description=__doc__)
    parser.add_argument("--cores", type=positive, default=os.cpu_count(), help="of the study")
    parser.add_argument("--keep", type=Path, help="clone to here, which is new, and leave it there")
    add_store(parser)
    options = parser.parse_args(arguments)
    if options.keep and options.keep.exists():
        raise InputError("it exists", file=options.keep, remedy="Name a folder that does not.")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    with tempfile.TemporaryDirectory() as temporary:
        clone = options.keep or Path(temporary, "clone")
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        make = ["make", f"CORES={options.cores}"]
        values: dict[str, Any] = {
            "cores": options.cores,
            "environment": measured([*make, "env"], clone, environment),
            "study": measured([*make, "study"], clone, environment),
            "again": measured([*make, "study"], clone, environment),
        }
        values["environment"]["megabytes"] = megabytes(clone / ".venv")
        values["study"]["megabytes"] = megabytes(clone / "results")
        values["study"]["largest_job_megabytes"] = largest_job(clone / "results")
    if options.store:
        store("fresh_clone", command("fresh", CORES=options.cores), values)
    print(json.dumps(values, indent=1))


if __name__ == "__main__":
    run(main)
