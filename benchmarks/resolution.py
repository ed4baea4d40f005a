"""Ambiguous trials, resolved by designed records: how often right, and after how many seconds.

Each trial is a film that hides one or two effects which its own record may not tell apart
(docs/trials.md, set `ambiguous`). The loop sees records alone; names are compared with what is
hidden when it has ended. The same trials are resolved with excitations of free form, with those of
fixed form alone, and with random ones.
"""

import argparse
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from benchmarks import stored
from benchmarks.command_line import add_store, positive, run
from dea import resolution
from dea.configuration.bench import BENCH
from dea.configuration.files import read_yaml
from dea.configuration.study import FILE, check_study
from dea.configuration.study import settings as written
from dea.discrepancy import Settings
from dea.effect_label import joined
from dea.excitation import design
from dea.plant import TRIAL_SETS, Trial, draw_trial
from dea.resolution import Design, Forms, Limits, Options, ResolutionOutcome, ResolutionRound
from dea.store import Record

OUTCOMES = Path("build/resolution.jsonl")
RECORDS = 2
FIRST = -1  # number of the record that is begun from


@dataclass
class Film:
    """Records of a trial: its device is driven in this process, from rest each time."""

    trial: Trial
    driven: list[Record] = field(default_factory=list)

    def design(
        self,
        number: int,
        records: Sequence[Record | xr.Dataset],
        make: Callable[[], Design | None],
    ) -> Design | None:
        """Return a new design."""
        return make()

    def record(self, number: int, u: np.ndarray) -> Record:
        """Return the record of an excitation, with noise of its own."""
        own = replace(self.trial, seed=self.trial.seed + number + 1)
        readings, _ = own.readings(Path(BENCH), u)
        rate = own.sampling_rate
        record = Record.of(u, readings, rate, units=("V", own.kind.unit))
        self.driven.append(record)
        return record

    def keep(self, found: ResolutionRound) -> None:
        """Keep nothing: what is wanted stands in the resolution."""


def violated(record: Record, limits: Limits) -> bool:
    """Return whether a record leaves the limits, by its input or by the measured output."""
    return not (limits.allows(record.u) and limits.holds(record.y))


def resolved(trial: Trial, forms: Forms, leaves: dict[str, Any], threads: int) -> dict[str, Any]:
    """Resolve a trial; return what was said, and what it cost."""
    source = Film(trial)
    first = source.record(FIRST, design(**trial.excitation))
    asked = leaves["resolution"]
    limits = Limits.of([first], asked["output_margin"])
    found = resolution.resolve(
        [first],
        trial.kind.simulation,
        source,
        limits,
        settings=Settings.of({**leaves, "system": trial.name}),
        options=Options(RECORDS, asked["duration"], asked["level"], asked["another"], forms),
        workers=threads,
    )
    hidden = {effect.name for effect in trial.effects}
    verdict, before = found.last.verdict, found.first.verdict
    names = set(verdict.names) if verdict.status == "named" else set()
    return {
        "trial": trial.name,
        "forms": str(forms),
        "hidden": joined(sorted(hidden)),
        "at first": f"{before.status}: {joined(before.names)}",
        "said": f"{verdict.status}: {joined(verdict.names)}",
        "outcome": str(found.outcome),
        "right": names == hidden,
        "wrong": bool(names - hidden),
        "decided": found.outcome is ResolutionOutcome.DECIDED,
        "records": len(found.rounds),
        "seconds": found.last.driven,
        "limit violated": any(violated(each, limits) for each in source.driven),
        "left open": bool(found.rounds or found.halted),
        "ambiguous at first": before.status == "ambiguous",
    }


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each kind of excitation, of the trials that a first record left open."""
    opened = rows[rows["left open"]]
    return pd.DataFrame(
        {
            "excitation": forms,
            "trials": len(own),
            "right": int(own["right"].sum()),
            "wrong": int(own["wrong"].sum()),
            "without a name": int((~own["right"] & ~own["wrong"]).sum()),
            "median seconds driven": float(own["seconds"].median()),
            "limit violated": int(own["limit violated"].sum()),
        }
        for forms, own in opened.groupby("forms", sort=False)
    )


def kept(file: Path, code: str, settings: str) -> dict[tuple[str, str], dict[str, Any]]:
    """Return the outcomes that are there, by trial and forms, of this code and these settings."""
    rows = stored.known(file, code)
    return {(row["trial"], row["forms"]): row for row in rows if row["settings"] == settings}


def main(arguments: list[str] | None = None) -> None:
    """Run the campaign, whose outcomes are kept one by one, and print its table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.resolution", description=__doc__)
    parser.add_argument("--count", type=positive, default=20, help="trials")
    sets = [name for name, each in TRIAL_SETS.items() if each.ambiguous]
    parser.add_argument("--set", choices=sets, default="ambiguous")
    parser.add_argument("--forms", nargs="+", choices=list(Forms), default=list(Forms))
    parser.add_argument("--cores", type=positive, default=1)
    add_store(parser)
    options = parser.parse_args(arguments)
    study = written(check_study(read_yaml(FILE, what="the configuration", example=FILE)))
    use, ambiguous = TRIAL_SETS[options.set]
    seed = study["trials"]["seeds"][options.set]
    code = stored.commit()
    leaves = json.dumps([options.set, study], sort_keys=True)
    settings = hashlib.sha256(leaves.encode()).hexdigest()
    known = kept(OUTCOMES, code, settings)
    rows = []
    for index in range(options.count):
        trial = draw_trial(Path(BENCH), seed, index, use, ambiguous=ambiguous)
        for forms in options.forms:
            row = known.get((trial.name, str(forms)))
            if row is None:
                row = resolved(trial, Forms(forms), study, options.cores)
                row |= {"commit": code, "settings": settings}
                stored.add(OUTCOMES, row)
            rows.append(row)
    lines = table(pd.DataFrame(rows)).to_markdown(index=False)
    if options.store:
        asked = {"COUNT": options.count, "SET": options.set, "FORMS": list(map(str, options.forms))}
        values = {"count": options.count, "set": options.set, "table": lines.splitlines()}
        stored.store("resolution", stored.command("resolution-trials", **asked), values)
    print(lines)


if __name__ == "__main__":
    run(main)
