"""Dry runs in forks of a process that has imported Snakemake, which is most of what one takes."""

import multiprocessing
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from subprocess import CompletedProcess
from tempfile import NamedTemporaryFile

FORKS = multiprocessing.get_context("forkserver")
FORKS.set_forkserver_preload(["snakemake.cli", "snakemake.api", "snakemake.workflow"])


def dry_run(
    arguments: list[str], folder: Path, environment: Mapping[str, str]
) -> CompletedProcess[str]:
    """Run ``snakemake`` with these arguments in a folder; all that it says is in ``stdout``."""
    with NamedTemporaryFile("r") as said:
        process = FORKS.Process(target=_run, args=(arguments, folder, dict(environment), said.name))
        process.start()
        process.join()
        return CompletedProcess(arguments, process.exitcode, said.read(), "")


def _run(arguments: list[str], folder: Path, environment: dict[str, str], said: str) -> None:
    from snakemake.cli import main

    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.path[:0] = environment["PYTHONPATH"].split(os.pathsep)
    with open(said, "wb") as file:
        for stream in (1, 2):
            os.dup2(file.fileno(), stream)
    main(arguments)
