"""Run every benchmark, print a table of ratios and write ``results/benchmark.json``."""

import argparse
import json
import os
import platform
import subprocess
import sys
import venv
from pathlib import Path

from benchmarks import acquisition, discrepancy, identification, tracking
from benchmarks.row import Row

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
    argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__).parse_args(arguments)
    python = peers_python()
    modules = identification, tracking, discrepancy, acquisition
    rows: list[Row] = [row for module in modules for row in module.run(python)]
    print(f"{'what':<66}{'ours':>11}{'peer':>11}{'ratio':>9}{'target':>9}")
    for row in rows:
        print(
            f"{row.name:<66}{row.ours_s:>9.4f} s{row.peer_s:>9.3f} s"
            f"{row.ratio:>8.3g}x{row.target:>8.3g}x"
        )
        if row.detail is not None:
            print(f"    {row.detail}")
        if row.lost:
            print(f"    lost: the peer's error is lower on {', '.join(row.lost)}")
    RESULT.parent.mkdir(exist_ok=True)
    machine = {"cores": os.cpu_count(), "machine": platform.machine()}
    stored = {"machine": machine, "rows": [row.leaves() for row in rows]}
    RESULT.write_text(json.dumps(stored, indent=1) + "\n")
    missed = [row.name for row in rows if not row.met]
    if missed:
        print("targets missed: " + "; ".join(missed), file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
