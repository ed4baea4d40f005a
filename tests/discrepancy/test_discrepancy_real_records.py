"""Measured records of public benchmarks: what is named, and what it is worth on another record."""

from pathlib import Path

import pytest
import yaml

from dea import store
from dea.discrepancy import Settings, diagnose

ROOT = Path(__file__).parents[2]
DATA = ROOT.parent / "shared" / "data"
CASES = ROOT / "config" / "cases"
pytestmark = pytest.mark.skipif(
    not DATA.exists(), reason="the public measured records are not in ../shared/data"
)


def diagnosed(name):
    """Diagnose a case as its rule does, from where the tests find its records."""
    config = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())
    case = yaml.safe_load((CASES / f"{name}.yaml").read_text())

    def read(record):
        file = record["file"].removeprefix("data/")
        return store.import_record(record | {"file": file}, CASES, DATA)

    leaves = {
        "discrepancy": config["discrepancy"],
        "split": case.get("split", {}),
        "seed": config["seed"],
        "system": name,
    }
    return diagnose(
        read(case["record"]),
        case["simulation"],
        test_records={part: read(record) for part, record in case["test_records"].items()},
        settings=Settings.of(leaves),
    ).verdict
