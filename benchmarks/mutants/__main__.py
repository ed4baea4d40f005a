"""Change the code in a few hundred places and see which changes the tests notice.

Writes ``results/mutants.json``, from which an interrupted campaign goes on, and
``results/mutants.md``; ``--store`` keeps the report for the documents.
"""

import argparse
import os
from pathlib import Path

from benchmarks.mutants.campaign import ROOMS, Campaign, run
from benchmarks.mutants.judgements import judgements
from benchmarks.mutants.report import kill_rate, markdown, values
from benchmarks.stored import store

ROOT = Path(__file__).parents[2]


def main() -> None:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__)
    parser.add_argument("--count", type=int, default=300, help="mutants to draw")
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--room", choices=ROOMS, action="append", help="only these rooms")
    parser.add_argument("--budget", type=float, default=60.0, help="seconds of tests for each")
    parser.add_argument("--cores", type=int, default=os.cpu_count(), help="mutants at a time")
    parser.add_argument(
        "--store", action="store_true", help="keep it as docs/measured/mutants.json"
    )
    given = parser.parse_args()
    campaign = Campaign(
        root=ROOT,
        folder=ROOT / "build" / "mutants",
        rooms=given.room or list(ROOMS),
        count=given.count,
        seed=given.seed,
        budget=given.budget,
        workers=given.cores,
    )
    rows = run(campaign, ROOT / "results" / "mutants.json")
    report = ROOT / "results" / "mutants.md"
    judged = judgements()
    report.write_text(markdown(rows, judged, given.seed, given.budget))
    if given.store:
        command = f"make mutants COUNT={given.count} SEED={given.seed}"
        store("mutants", command, values(rows, judged))
    rate = kill_rate([str(row["outcome"]) for row in rows])
    if rate is not None:
        print(f"{100 * rate[0]:.1f} % of {len(rows)} mutants were noticed; survivors: {report}")


if __name__ == "__main__":
    main()
