"""Random faults between the acquisition's command and two devices; the devices judge.

Prints each schedule that broke a law, reduced to the faults that it takes, as a line of JSON that
``--schedule`` runs again. ``--keep`` keeps the verdicts as well, from which a campaign that was
interrupted goes on. ``--store`` keeps the counts in ``docs/measured/faults.json``, which the
documents quote.
"""

import argparse
import collections
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.bars import progress_bars
from benchmarks.faults.campaign import AT_A_TIME, Campaign
from benchmarks.faults.examples import examples
from benchmarks.faults.schedule import loads
from benchmarks.faults.strategies import draw
from benchmarks.faults.verdicts import Verdict, Verdicts
from benchmarks.stored import store

VICTIMS = ("plain", "bench")


def main() -> None:
    """Run the campaign that the command line asks for; exit with 1 where a law was broken."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="schedules for each victim")
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--victim", choices=VICTIMS, action="append", help="only this victim")
    parser.add_argument("--longest", type=float, default=6.0, help="s, of a fault")
    parser.add_argument("--at-a-time", type=int, default=AT_A_TIME, help="runs at a time")
    parser.add_argument("--keep", type=Path, help="folder for verdicts and what broken laws left")
    parser.add_argument("--no-reduction", action="store_true", help="print schedules as drawn")
    parser.add_argument("--schedule", action="append", help="run this schedule alone (JSON)")
    parser.add_argument("--examples", action="store_true", help="run the known faults, one each")
    parser.add_argument("--only", default="", help="examples whose names hold this")
    parser.add_argument("--store", action="store_true", help="keep the counts for the documents")
    given = parser.parse_args()
    if given.store and (given.examples or given.schedule or given.victim):
        parser.error("--store keeps what random schedules of all victims did: name none")
    if given.examples:
        runs = [(name, run) for name, run in examples().items() if given.only in name]
    elif given.schedule:
        runs = [("", loads(text)) for text in given.schedule]
    else:
        runs = [
            ("", schedule)
            for victim in given.victim or VICTIMS
            for schedule in draw(victim, given.count, given.seed, given.longest)
        ]
    random = not (given.examples or given.schedule)  # what is asked for by name runs again
    verdicts: list[Verdict] = []
    with progress_bars() as progress:
        bar = progress.add_task("schedules", total=len(runs))
        # One after the other, since served benches keep a core busy.
        for victim in VICTIMS:
            own = [(name, schedule) for name, schedule in runs if schedule.victim == victim]
            names = [name for name, _ in own]

            def tell(number: int, verdict: Verdict, names: Sequence[str] = names) -> None:
                progress.advance(bar)
                if verdict.broken:
                    said = names[number], verdict.schedule.dumps(), *verdict.broken
                    print(*said, sep="\n    ", flush=True)

            keep = given.keep and given.keep / victim
            known = Verdicts(keep / "verdicts.jsonl" if keep and random else None)
            campaign = Campaign(given.at_a_time, keep, known)
            verdicts += campaign.judge(
                [schedule for _, schedule in own], not given.no_reduction, tell
            )
    laws = collections.Counter(
        sentence.split(":")[0] for verdict in verdicts for sentence in verdict.broken
    )
    counts = _counts(verdicts)
    print(f"{counts['broken']} of {counts['runs']} runs broke a law", dict(laws) or "")
    print(f"the output was driven in {counts['driven']} runs")
    print("exit status of the command:", counts["status"])
    if given.store:
        values = {victim: _counts([v for v in verdicts if v.schedule.victim == victim])
                  for victim in VICTIMS}  # fmt: skip
        store("faults", "make faults", {"seed": given.seed, "all": counts, **values})
    sys.exit(counts["broken"] > 0)


def _counts(verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """Return how many runs there were, how many broke a law, drove the output, ended how."""
    statuses = collections.Counter(str(verdict.status) for verdict in verdicts)
    return {
        "runs": len(verdicts),
        "broken": sum(bool(verdict.broken) for verdict in verdicts),
        "driven": sum(verdict.driven for verdict in verdicts),
        "status": dict(sorted(statuses.items())),
    }


if __name__ == "__main__":
    main()
