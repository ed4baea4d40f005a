"""Count how often the 95 % bands contain the truth of known plants.

Writes ``results/coverage.csv``, with a row for each plant, and ``results/coverage.md``. The
documents quote the latter where all plants were counted.
"""

import argparse
import os
from dataclasses import replace
from pathlib import Path

from benchmarks.coverage.campaign import Settings, run
from benchmarks.coverage.report import as_csv, as_markdown, rows
from benchmarks.stored import store

ROOT = Path(__file__).parents[2]
LEGEND = """\
Share of 95 % intervals that contain the truth, with its own 95 % interval, over all plants.
Targets: 92 to 98 % for responses, 90 to 98 % for parameters. `!` marks a share whose interval lies
outside of the target, `?` one that these records do not decide.
"""


def main() -> None:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="records of each cell")
    parser.add_argument("--seed", type=int, default=1, help="of the records")
    parser.add_argument("--samples", type=int, default=Settings.samples, help="of a record")
    parser.add_argument("--cores", type=int, default=os.cpu_count(), help="jobs at a time")
    parser.add_argument("--plant", action="append", help="only these plants, none of them drifting")
    parser.add_argument("--drifting", action="store_true", help="only plants that drift")
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "coverage")
    given = parser.parse_args()
    settings = Settings(given.count, given.samples, given.seed, given.cores)
    if given.plant:
        settings = replace(settings, plants=tuple(given.plant), drifting=())
    elif given.drifting:
        settings = replace(settings, plants=())
    table = rows(run(settings))
    given.output.parent.mkdir(parents=True, exist_ok=True)
    given.output.with_suffix(".csv").write_text(as_csv(table))
    lines = as_markdown(table)
    text = "\n".join([LEGEND, *lines, ""])
    given.output.with_suffix(".md").write_text(text)
    if not (given.plant or given.drifting):
        command = f"make coverage COUNT={given.count} SEED={given.seed}"
        store("coverage", command, {"count": given.count, "table": lines})
    print(text)


if __name__ == "__main__":
    main()
