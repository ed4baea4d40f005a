"""Random faults between the acquisition's command and two devices; the devices judge.

Prints each schedule that broke a law, reduced to the faults that it takes, as a line of JSON that
``--schedule`` runs again. ``--keep`` keeps the verdicts as well, from which a campaign that was
interrupted goes on. ``--store`` keeps the counts for the documents.
"""

import argparse
import collections
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks import command_line
from benchmarks.bars import progress_bars
from benchmarks.command_line import add_store, positive, positive_time, seed_number
from benchmarks.faults.campaign import AT_A_TIME, Campaign
from benchmarks.faults.examples import examples
from benchmarks.faults.schedule import Schedule, loads
from benchmarks.faults.strategies import draw
from benchmarks.faults.verdicts import Verdict, Verdicts
from benchmarks.stored import command, store

VICTIMS = ("plain", "bench")
LONGEST = 6.0  # s


def main(arguments: list[str] | None = None) -> int:
    """Run the campaign that the command line asks for; return 1 where a law was broken."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--count", type=positive, default=100, help="schedules for each victim")
    parser.add_argument("--seed", type=seed_number, default=1, help="of the draw")
    parser.add_argument("--victim", choices=VICTIMS, action="append", help="only this victim")
    parser.add_argument("--longest", type=positive_time, default=LONGEST, help="s, of a fault")
    parser.add_argument("--at-a-time", type=positive, default=AT_A_TIME, help="runs at a time")
    parser.add_argument("--keep", type=Path, help="folder for verdicts and what broken laws left")
    parser.add_argument("--no-reduction", action="store_true", help="print schedules as drawn")
    parser.add_argument("--schedule", type=schedule, action="append", metavar="JSON",
                        help="run this schedule alone")  # fmt: skip
    parser.add_argument("--examples", action="store_true", help="run the known faults, one each")
    parser.add_argument("--only", default="", help="examples whose names hold this")
    add_store(parser)
    given = parser.parse_args(arguments)
    if given.store and (given.examples or given.schedule or given.victim):
        parser.error("--store keeps what random schedules of all victims did: name none")
    if given.only and not given.examples:
        parser.error("--only chooses from --examples: ask for these, too")
    if given.examples:
        runs = [(name, run) for name, run in examples().items() if given.only in name]
        if not runs:
            parser.error(f"no example's name holds {given.only!r}: {', '.join(examples())}")
    elif given.schedule:
        runs = [("", each) for each in given.schedule]
    else:
        runs = [
            ("", each)
            for victim in given.victim or VICTIMS
            for each in draw(victim, given.count, given.seed, given.longest)
        ]
    random = not (given.examples or given.schedule)  # what is asked for by name runs again
    verdicts: list[Verdict] = []
    with progress_bars() as progress:
        bar = progress.add_task("schedules", total=len(runs))
        # One after the other, since served benches keep a core busy.
        for victim in VICTIMS:
            own = [(name, each) for name, each in runs if each.victim == victim]
            names = [name for name, _ in own]

            def tell(number: int, verdict: Verdict, names: Sequence[str] = names) -> None:
                progress.advance(bar)
                if verdict.broken:
                    said = names[number], verdict.schedule.dumps(), *verdict.broken
                    print(*said, sep="\n    ", flush=True)

            keep = given.keep and given.keep / victim
            known = Verdicts(keep / "verdicts.jsonl" if keep and random else None)
            campaign = Campaign(given.at_a_time, keep, known)
            verdicts += campaign.judge([each for _, each in own], not given.no_reduction, tell)
    laws = collections.Counter(
        sentence.split(":")[0] for verdict in verdicts for sentence in verdict.broken
    )
    counts = _counts(verdicts)
    print(f"{counts['broken']} of {counts['runs']} runs broke a law", dict(laws) or "")
    print(f"the output was driven in {counts['driven']} runs")
    print("exit status of the command:", counts["status"])
    if given.store:
        asked = {"COUNT": given.count, "SEED": given.seed, "LONGEST": given.longest}
        values = {victim: _counts([v for v in verdicts if v.schedule.victim == victim])
                  for victim in VICTIMS}  # fmt: skip
        store("faults", command("faults", **asked), {"seed": given.seed, "all": counts, **values})
    return int(counts["broken"] > 0)


def schedule(text: str) -> Schedule:
    """Return the schedule that an option gives as JSON."""
    try:
        found = loads(text)
    except (AttributeError, TypeError, ValueError) as error:
        raise argparse.ArgumentTypeError(f"{text} is no schedule: {error}") from None
    if found.victim not in VICTIMS:
        raise argparse.ArgumentTypeError(f"{found.victim} is none of {', '.join(VICTIMS)}")
    return found


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
    command_line.run(main)
