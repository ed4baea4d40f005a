"""Measured records of public benchmarks: what is named, and what it is worth on another record."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from dea import store
from dea.configuration.record import is_part_of
from dea.discrepancy import Settings, diagnose
from dea.simulation import catalogue
from measured_records import DATA, needs_records

ROOT = Path(__file__).parents[2]
CASES = ROOT / "config" / "cases"
pytestmark = [needs_records, pytest.mark.campaign]


def diagnosed(name, effects=(), **record):
    """Diagnose a case as its rule does, from where the tests find its records.

    ``effects`` are offered instead of all; ``record`` changes the case's.
    """
    config = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())
    case = yaml.safe_load((CASES / f"{name}.yaml").read_text())

    def read(record):
        file = record["file"].removeprefix("data/")
        return store.import_record(record | {"file": file}, CASES, DATA)

    leaves = {
        "discrepancy": config["discrepancy"] | {"effects": effects},
        "split": case.get("split", {}),
        "seed": config["seed"],
        "system": name,
    }
    return diagnose(
        [read(case["record"] | record), *map(read, case.get("records", {}).values())],
        case["simulation"],
        test_records={
            part: read(test)
            for part, test in case["test_records"].items()
            if not is_part_of(test, case["record"] | record)
        },
        settings=Settings.of(leaves),
    )


def test_the_drives_sensor_is_named_and_serves_on_the_other_record():
    verdict = diagnosed("coupled_drives_1").verdict
    assert verdict.status == "named", verdict.sentence
    assert verdict.names == ("sensor_nonlinearity",)
    other = verdict.certified["records"]["record_2"]
    assert other["after"] <= 1.26
    assert other["after"] < 0.75 * other["before"]


def test_the_tanks_overflow_leads_and_serves_on_the_other_record():
    """What acts on the lower level, or on its reading, is open: one record does not tell."""
    verdict = diagnosed("cascaded_tanks").verdict
    assert verdict.status in ("named", "ambiguous"), verdict.sentence
    assert verdict.names[0] == "end_stop"
    assert verdict.presence["effects"]["end_stop"] > 0.6
    other = verdict.certified["records"]["validation"]
    assert other["after"] <= 0.354 < other["before"]


def test_the_cubic_spring_of_the_silverbox_is_named_and_serves_beyond_what_was_seen():
    offered = ("strain_stiffening", "sensor_nonlinearity", "dead_zone")
    diagnosis = diagnosed("silverbox", offered, rows=[40_650, 58_650])
    verdict = diagnosis.verdict
    assert verdict.status == "named", verdict.sentence
    assert verdict.names == ("strain_stiffening",)
    effect = catalogue()["strain_stiffening"]
    where = diagnosis.final.extended.layout.effect_slices[0]
    q = diagnosis.final.values[where.start : where.stop]
    curve = effect.memory(q)
    z = np.linspace(0.2, 2.0, 10)
    odd = [effect.force(v, 0.0, curve, q) - effect.force(-v, 0.0, curve, q) for v in z]
    # The stiffness beside it is the simulation's.
    X = np.column_stack([z, z**3])
    weights = np.linalg.lstsq(X, odd, rcond=None)[0]
    assert weights[1] < 0.0
    assert (odd - X @ weights).std() < 0.05 * (weights[1] * z**3).std()
    assert verdict.certified["records"]["arrow"]["after"] <= 1.12e-3


def test_the_loops_of_the_piezo_are_named_and_each_record_predicts_the_other():
    """One amplitude does not tell a loop from creep beside a bent sensor; a falling one does."""
    verdict = diagnosed("piezo_stage").verdict
    assert verdict.status == "named", verdict.sentence
    assert verdict.names == ("rate_independent_hysteresis",)
    records = verdict.certified["records"]
    for name in ("record_1", "record_2"):
        assert records[name]["after"] < 0.25 * records[name]["before"]
    # Most of what is left there is an offset that creeps.
    assert records["second_fall"]["after"] < 0.95 * records["second_fall"]["before"]


@pytest.mark.parametrize("name", ["two_heaters_1", "two_heaters_2"])
def test_ten_minutes_of_two_heaters_are_too_short_for_a_name(name):
    """It is five of the slowest time constants: drift, fault and lag look alike."""
    verdict = diagnosed(name).verdict
    assert verdict.status in ("ambiguous", "unknown"), verdict.sentence
