"""Run every benchmark, print a table of ratios and write ``results/benchmark.json``.

``--store`` keeps the tables for the documents.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import venv
from pathlib import Path

from benchmarks import acquisition, discrepancy, identification, tracking
from benchmarks.command_line import add_store, run
from benchmarks.row import HEAD, Row, table, table_of_cases
from benchmarks.stored import command, store

ROOT = Path(__file__).parents[1]
REQUIREMENTS = ROOT / "benchmarks" / "peers.txt"
PEERS = ROOT / ".venv-peers"
RESULT = ROOT / "results" / "benchmark.json"


def peers_python() -> Path:
    """Return the interpreter of the peers' environment, which is made where it is missing."""
    python = PEERS / "bin" / "python"
    stamp = PEERS / "installed"
    if not stamp.exists() or stamp.read_text() != REQUIREMENTS.read_text():
        venv.create(PEERS, with_pip=True, clear=True)
        pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*pip, "--requirement", str(REQUIREMENTS)], check=True)
        stamp.write_text(REQUIREMENTS.read_text())
    return python


def main(arguments: list[str] | None = None) -> int:
    """Run all benchmarks, print and store them; return 1 where a target is missed, else 0."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    add_store(parser)
    given = parser.parse_args(arguments)
    python = peers_python()
    modules = identification, tracking, discrepancy, acquisition
    rows: list[Row] = [row for module in modules for row in module.run(python)]
    print("\n".join([HEAD, *(line for row in rows for line in row.lines())]))
    RESULT.parent.mkdir(exist_ok=True)
    machine = {"cores": os.cpu_count(), "machine": platform.machine()}
    stored = {"machine": machine, "rows": [row.leaves() for row in rows]}
    RESULT.write_text(json.dumps(stored, indent=1) + "\n")
    if given.store:
        tables = {"table": table(rows), "cases": table_of_cases(rows)}
        store("benchmark", command("benchmark"), tables)
    missed = [row.name for row in rows if not row.met]
    if missed:
        print("targets missed: " + "; ".join(missed), file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":
    run(main)
