"""Count how often the 95 % bands contain the truth of known plants.

Writes ``results/coverage.csv``, with a row for each plant, and ``results/coverage.md``, with those
of all plants together. ``--store`` keeps the latter as ``docs/measured/coverage.json``, which the
documents quote.
"""

import argparse
import os
from dataclasses import replace
from pathlib import Path

from benchmarks import command_line
from benchmarks.command_line import add_store, positive, seed_number
from benchmarks.coverage.campaign import Settings, run
from benchmarks.coverage.plants import plants
from benchmarks.coverage.report import rows, written
from benchmarks.stored import command, store

ROOT = Path(__file__).parents[2]


def main(arguments: list[str] | None = None) -> None:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("--count", type=positive, default=100, help="records of each cell")
    parser.add_argument("--seed", type=seed_number, default=1, help="of the records")
    parser.add_argument("--samples", type=positive, default=Settings.samples, help="of a record")
    parser.add_argument("--cores", type=positive, default=os.cpu_count(), help="jobs at a time")
    parser.add_argument("--plant", action="append", choices=list(plants()),
                        help="only these plants, none of them drifting")  # fmt: skip
    parser.add_argument("--drifting", action="store_true", help="only plants that drift")
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "coverage")
    add_store(parser)
    given = parser.parse_args(arguments)
    if given.store and (given.plant or given.drifting):
        parser.error("--store keeps what all plants gave: choose none")
    settings = Settings(given.count, given.samples, given.seed, given.cores)
    if given.plant:
        settings = replace(settings, plants=tuple(given.plant), drifting=())
    elif given.drifting:
        settings = replace(settings, plants=())
    table = rows(run(settings))
    lines, text = written(table, given.output)
    if given.store:
        asked = {"COUNT": given.count, "SEED": given.seed, "SAMPLES": given.samples}
        values = {name.lower(): value for name, value in asked.items()}
        store("coverage", command("coverage", **asked), {**values, "table": lines})
    print(text)


if __name__ == "__main__":
    command_line.run(main)
