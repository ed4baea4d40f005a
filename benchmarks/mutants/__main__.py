"""Change the code in a few hundred places and see which changes the tests notice.

Writes ``results/mutants.json``, from which an interrupted campaign goes on, and
``results/mutants.md``; ``--store`` keeps the report for the documents.
"""

import argparse
import os
import signal
from pathlib import Path
from types import FrameType
from typing import NoReturn

from benchmarks import command_line
from benchmarks.command_line import add_store, positive, positive_time, seed_number
from benchmarks.mutants.campaign import ROOMS, Campaign, run
from benchmarks.mutants.judgements import judgements
from benchmarks.mutants.report import kill_rate, markdown, values
from benchmarks.stored import command, store

ROOT = Path(__file__).parents[2]


def main(arguments: list[str] | None = None) -> None:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__)
    parser.add_argument("--count", type=positive, default=300, help="mutants to draw")
    parser.add_argument("--seed", type=seed_number, default=1, help="of the draw")
    parser.add_argument("--room", choices=ROOMS, action="append", help="only these rooms")
    parser.add_argument("--budget", type=positive_time, default=60.0, help="s of tests for each")
    parser.add_argument("--cores", type=positive, default=os.cpu_count(), help="mutants at a time")
    add_store(parser)
    given = parser.parse_args(arguments)
    campaign = Campaign(
        root=ROOT,
        folder=ROOT / "build" / "mutants",
        rooms=given.room or list(ROOMS),
        count=given.count,
        seed=given.seed,
        budget=given.budget,
        workers=given.cores,
    )
    # What it runs is in sessions of its own, which end with it as it ends, and not with a signal.
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _end)
    rows = run(campaign, ROOT / "results" / "mutants.json")
    report = ROOT / "results" / "mutants.md"
    judged = judgements()
    report.write_text(markdown(rows, judged, given.seed, given.budget))
    if given.store:
        asked = {"COUNT": given.count, "SEED": given.seed, "BUDGET": given.budget}
        made_by = command("mutants", **asked, ROOM=given.room)
        store("mutants", made_by, values(rows, judged))
    rate = kill_rate([str(row["outcome"]) for row in rows])
    if rate is not None:
        print(f"{100 * rate[0]:.1f} % of {len(rows)} mutants were noticed; survivors: {report}")


def _end(number: int, frame: FrameType | None) -> NoReturn:
    raise SystemExit(128 + number)


if __name__ == "__main__":
    command_line.run(main)
