"""Keep the rates of a finished campaign of blind trials, and its time, for the documents."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from benchmarks.command_line import run
from benchmarks.stored import commit, stored
from benchmarks.stored import store as keep
from dea import store
from dea.errors import InputError
from dea.tables.trials import rates
from dea.trials import BOTH, ON_FOREIGN, ON_NOTHING, wilson

TRIALS = Path("results/trials")
# The first trial of forms that no diagnosis had been tuned on when it was judged.
FORMS_SINCE = 1472
COUNTED = ("right name", "wrong name", BOTH, ON_NOTHING, ON_FOREIGN)


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


def with_one_more(
    campaigns: Sequence[Mapping[str, Any]], scores: xr.Dataset, made_at: str
) -> list[Mapping[str, Any]]:
    """Return the campaigns on the present forms with that of ``scores``, in order of their trials.

    It replaces those that share a trial with it.
    """
    numbers = scores["trial"].values.astype(int)
    first, last = int(numbers.min()), int(numbers.max())
    one = {"first": first, "last": last, "commit": made_at, "counts": counts(scores)}
    others = [each for each in campaigns if each["last"] < first or each["first"] > last]
    present = [each for each in [*others, one] if each["first"] >= FORMS_SINCE]
    return sorted(present, key=lambda each: each["first"])


def counts(scores: xr.Dataset) -> dict[str, list[int]]:
    """Return, for each rate of ``COUNTED``, in how many trials it came true, and of how many."""
    found = {name: np.zeros(2) for name in COUNTED}
    for measure, rate, trials in zip(
        scores["measure"].values, scores["rate"].values, scores["rate_trials"].values, strict=True
    ):
        # What hides nothing has a rate for each kind of noise.
        name = ON_NOTHING if str(measure).startswith(ON_NOTHING) else str(measure)
        if name in found and trials:
            found[name] += (rate * trials, trials)
    return {name: [round(number) for number in both] for name, both in found.items()}


def together(campaigns: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, float]]:
    """Return each rate of ``COUNTED`` over several campaigns: counts and 95 % interval, in %."""
    summed: dict[str, dict[str, float]] = {}
    for name in COUNTED:
        number, trials = (sum(one["counts"][name][part] for one in campaigns) for part in (0, 1))
        if trials:
            percent = {
                key: 100.0 * each
                for key, each in wilson(number, trials)._asdict().items()
                if key != "trials"
            }
            summed[name] = {"number": number, "trials": trials, **percent}
    return summed


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
    folder = TRIALS / options.set
    values = measured(folder)
    campaigns = stored("trials").get("campaigns", [])
    if options.set == "reporting":
        campaigns = with_one_more(campaigns, store.read(folder / "scores.nc"), commit())
    values |= {"campaigns": campaigns, "together": together(campaigns)}
    command = f"make trials FIRST={values['first']} COUNT={values['count']} SET={options.set}"
    keep("trials", command, values)
    print("\n".join(values["table"]))


if __name__ == "__main__":
    run(main)
