"""Set methods that name what a simulation is missing side by side, on the same trials and records.

Trials and answers are kept in ``build/naming``, so that an interrupted campaign goes on where it
ended and a new method is asked alone. ``--store`` keeps the tables for the documents, into which
``make numbers`` writes them.
"""

import argparse
import os
from collections import Counter
from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from benchmarks import stored
from benchmarks.command_line import add_store, positive, run, seed_number
from benchmarks.naming.campaign import Settings, Tried, of_records, of_trials
from benchmarks.naming.measured import RECORDS
from benchmarks.naming.methods import REFERENCE, methods
from benchmarks.naming.scores import ranked, scored, table, table_of_answers
from benchmarks.naming.trials import config
from dea.trials import KINDS, kind_of

SETS = ("reporting", "tuning")


def values(tried: Sequence[Tried], records: Sequence[Tried], settings: Settings) -> dict[str, Any]:
    """Return what the documents quote of a campaign."""
    found = {name: scored(tried, name) for name in methods()}
    return {
        "set": settings.of_set,
        "seed": settings.seed,
        "count": len(tried),
        "longest": settings.longest,
        "kinds": {kind: sum(kind_of(each.label) == kind for each in tried) for kind in KINDS},
        "devices": dict(Counter(each.label.device for each in tried)),
        "methods": {name: [each.title, each.source] for name, each in methods().items()},
        "table": table(tried),
        "each": table_of_answers(tried, ranked(tried)),
        "records": table_of_answers(records, ranked(tried)) if records else [],
        "runs_away": sum(not isfinite(each.said[REFERENCE].error) for each in tried),
        "failed": {
            name: sum(bool(each.said[name].failed) for each in [*tried, *records])
            for name in methods()
        },
        "trials": {
            each.name: {
                "hidden": sorted(each.label.effects),
                "outcomes": {name: found[name][k].outcome for name in methods()},
                "ratios": {name: _rounded(found[name][k].ratio) for name in methods()},
            }
            for k, each in enumerate(tried)
        },
    }


def made_at(*tried: Tried) -> str:
    """Return the commits that the answers were made at: several, where a campaign went on later."""
    return ", ".join(sorted({said.commit for each in tried for said in each.said.values()}))


def command(settings: Settings, records: Sequence[str]) -> str:
    """Return the command that makes these tables."""
    return stored.command(
        "benchmark-naming",
        COUNT=settings.count,
        SET=settings.of_set,
        SEED=settings.seed,
        LONGEST=settings.longest,
        RECORDS=None if list(records) == list(RECORDS) else list(records),
    )


def _rounded(ratio: float) -> float | None:
    return round(ratio, 4) if isfinite(ratio) else None


def main(arguments: list[str] | None = None) -> None:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.naming", description=__doc__)
    parser.add_argument("--count", type=positive, default=40, help="trials")
    parser.add_argument("--set", choices=SETS, default="reporting", help="of the trials")
    parser.add_argument("--seed", type=seed_number, help="of the trials; else the set's own")
    parser.add_argument(
        "--longest", type=positive, default=6000, help="samples of a record, at most"
    )
    parser.add_argument("--cores", type=positive, default=os.cpu_count(), help="trials at a time")
    parser.add_argument("--keep", type=Path, default=Path("build/naming"), help="folder")
    parser.add_argument("--records", nargs="*", choices=list(RECORDS), default=list(RECORDS),
                        help="public records; all if not given, none if it is empty")  # fmt: skip
    add_store(parser)
    given = parser.parse_args(arguments)
    seed = config()["trials"]["seeds"][given.set] if given.seed is None else given.seed
    settings = Settings(given.set, seed, given.count, given.longest, given.cores, given.keep)
    records = of_records(given.records, given.keep, given.cores) if given.records else []
    tried = of_trials(settings)
    found = values(tried, records, settings)
    if given.store:
        made_by = command(settings, given.records)
        stored.store("naming", made_by, found, made_at(*tried, *records))
    print("\n".join([*found["table"], "", *found["records"]]))


if __name__ == "__main__":
    run(main)
