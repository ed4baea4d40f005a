"""Keep the rates of a finished campaign of blind trials, and its time, for the documents."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.command_line import run
from benchmarks.stored import store as keep
from dea import store
from dea.errors import InputError
from dea.tables.trials import rates

TRIALS = Path("results/trials")


def measured(folder: Path) -> dict[str, Any]:
    """Return what the documents quote of the campaign in ``folder``.

    Its table of rates as lines, the numbers of its first and last trial, the number of trials and
    of those of each device, and the mean time of a core for each step of a trial, in s.

    Raises
    ------
    InputError
        If it has no scores.
    """
    file = folder / "scores.nc"
    if not file.exists():
        remedy = f"Run the campaign: make trials SET={folder.name}"
        raise InputError("the file does not exist", file=file, remedy=remedy)
    scores = store.read(file)
    count, numbers = scores.sizes["trial"], scores["trial"].values.astype(int)
    first, last = int(numbers.min()), int(numbers.max())
    batches = _batches(folder, first, last)
    return {
        "first": first,
        "last": last,
        "count": count,
        "devices": pd.Series(scores["device"].values).value_counts().to_dict(),
        "table": rates(scores).shown.to_markdown(index=False, disable_numparse=True).splitlines(),
        "seconds": {step: _seconds(batches, step) / count for step in ("draw", "diagnose")},
    }


def _batches(folder: Path, first: int, last: int) -> list[Path]:
    """Return the folders that hold trials ``first`` to ``last``, each once.

    A folder may also hold batches of campaigns that began or ended elsewhere.
    """
    found: list[Path] = []
    while first <= last:
        ends = (int(path.name.partition("-")[2]) for path in folder.glob(f"{first:04d}-*"))
        end = max(end for end in ends if end <= last)
        found.append(folder / f"{first:04d}-{end:04d}")
        first = end + 1
    return found


def _seconds(batches: list[Path], step: str) -> float:
    files = [batch / "benchmark" / f"{step}.tsv" for batch in batches]
    return float(np.sum([pd.read_csv(file, sep="\t")["cpu_time"].iloc[0] for file in files]))


def main(arguments: list[str] | None = None) -> None:
    """Keep the campaign of one set."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trials", description=__doc__)
    parser.add_argument("--set", default="reporting", help="of the trials")
    options = parser.parse_args(arguments)
    values = measured(TRIALS / options.set)
    command = f"make trials FIRST={values['first']} COUNT={values['count']} SET={options.set}"
    keep("trials", command, values)
    print("\n".join(values["table"]))


if __name__ == "__main__":
    run(main)
