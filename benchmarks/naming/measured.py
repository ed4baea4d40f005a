"""Public measured records as tasks, with what the literature says is missing there."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.naming.task import Posed
from benchmarks.naming.trials import KEPT_BACK, config
from dea import store, trials
from dea.configuration.files import read_yaml
from dea.discrepancy import Settings
from dea.errors import InputError
from dea.simulation import load_simulation

CASES = Path("config/cases")


@dataclass(frozen=True)
class Known:
    """What is missing from the simulation of a case, and how its record is used."""

    effects: frozenset[str]
    source: str
    kept_back: float = KEPT_BACK
    changes: dict[str, Any] = field(default_factory=dict)  # of the case's record


# The two hundred samples of each drive's record that its case leaves for testing are kept back.
_DRIVE: dict[str, Any] = {"kept_back": 0.4, "changes": {"rows": [0, 500]}}
_DRIVES = "Wigren and Schoukens, technical report 2017-024, Uppsala University"
RECORDS = {
    "cascaded_tanks": Known(
        frozenset({"end_stop"}),
        "both tanks overflow: Schoukens and Noël, IFAC-PapersOnLine 50 (2017) 446",
    ),
    "coupled_drives_1": Known(
        frozenset({"sensor_nonlinearity"}), f"the sensor reads the speed's magnitude: {_DRIVES}",
        **_DRIVE,
    ),
    "coupled_drives_2": Known(
        frozenset({"sensor_nonlinearity"}), f"the sensor reads the speed's magnitude: {_DRIVES}",
        **_DRIVE,
    ),
    "coupled_drives_3": Known(
        frozenset(), "nothing that this record could prove: config/published_errors.yaml", **_DRIVE
    ),
    "piezo_stage": Known(
        frozenset({"rate_independent_hysteresis"}),
        "hysteresis of the ceramic: Aye and Ang 2018",
    ),
    "silverbox": Known(
        frozenset({"strain_stiffening"}),
        "a cubic spring: Wigren and Schoukens, European Control Conference 2013",
        changes={"rows": [40_650, 49_650]},  # one realisation of the nine
    ),
}  # fmt: skip


def posed(name: str, root: Path = Path()) -> Posed:
    """Return the task that a case sets; ``root`` is the folder that holds ``data/``.

    Raises
    ------
    InputError
        If its record has not been fetched.
    """
    known, file = RECORDS[name], CASES / f"{name}.yaml"
    case, own = read_yaml(file, what="the case", example="config/cases"), config()
    record = store.import_record(case["record"] | known.changes, file, root)
    leaves = {key: own[key] for key in ("seed", "discrepancy")}
    leaves |= {"system": name, "split": case.get("split", {})}
    return Posed.of(
        name, store.signals(record), known.kept_back, load_simulation(case["simulation"]),
        Settings.of(leaves),
    )  # fmt: skip


def files(name: str, root: Path = Path()) -> frozenset[Path]:
    """Return the files that the task of a case depends on: its record's, the case and this one.

    Raises
    ------
    InputError
        If its record has not been fetched.
    """
    case = CASES / f"{name}.yaml"
    record = root / read_yaml(case, what="the case", example="config/cases")["record"]["file"]
    if not record.exists():
        raise InputError(
            "the record has not been fetched", file=record, remedy="Fetch it with `make records`"
        )
    return frozenset({Path(__file__), case, record})


def label(name: str) -> trials.Label:
    """Return what is known to be missing."""
    return trials.Label(RECORDS[name].effects, False, float("nan"), "measured", device=name)
