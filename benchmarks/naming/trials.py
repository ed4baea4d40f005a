"""Blind trials as tasks: what a trial hides stays sealed until every method has answered."""

import json
import shutil
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from benchmarks.naming.code import digest, imported
from benchmarks.naming.task import Posed
from dea import store, trials
from dea.configuration.bench import BENCH, plain_settings, read_bench
from dea.configuration.files import read_yaml
from dea.configuration.study import FILE, check_study
from dea.configuration.study import settings as written
from dea.discrepancy import Settings
from dea.plant import Trial
from dea.simulation import load_simulation
from dea.stages.trial_acquire import trial_acquire
from dea.stages.trial_draw import trial_draw
from dea.stages.trial_log import trial_log

# Part of a record that is kept from the methods, its last.
KEPT_BACK = 0.2
# The files that say how a trial is set, besides what the record holds.
FILES = frozenset({Path(__file__)})
# What a drawn trial and its record depend on.
_CONFIGURATION = ("config/config.yaml", "config/bench.yaml", "config/devices/*.yaml")
_MODULES = (
    "dea.stages.trial_draw", "dea.stages.trial_acquire", "dea.stages.trial_log",
    "dea.bench.__main__",
)  # fmt: skip


@dataclass(frozen=True)
class Drawn:
    """A trial that has been drawn: its folder and what is public of it."""

    folder: Path
    name: str
    public: dict[str, Any]

    @property
    def samples(self) -> int:
        """Length of its record."""
        excitation = self.public["excitation"]
        return round(float(excitation["duration"] * excitation["sampling_rate"]))


@cache
def config() -> dict[str, Any]:
    """Return the study's configuration as it is written."""
    return written(check_study(read_yaml(FILE, what="the configuration", example=FILE)))


def draw(folder: Path, of_set: str, seed: int, index: int) -> Drawn:
    """Draw a trial and seal it, unless that is done."""
    sealed, commitment, made_by = (
        folder / name for name in ("sealed", "commitment.json", "code.txt")
    )
    code = digest(_CONFIGURATION, imported(*_MODULES) | FILES)
    if not (commitment.exists() and made_by.exists() and made_by.read_text() == code):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        made_by.write_text(code)
        wanted = {"set": of_set, "seed": seed, "first": index, "last": index, "bench": _bench()}
        trial_draw(wanted, sealed, commitment)
    ((name, public),) = json.loads(commitment.read_text()).items()
    return Drawn(folder, name, public)


def acquired(drawn: Drawn) -> Path:
    """Record the trial's device, unless that is done; return the record's file."""
    folder = drawn.folder
    film = drawn.public["device"] == "film"
    places = [folder / name for name in (("records", "truth") if film else ("logs", "log_truth"))]
    record = places[0] / f"{drawn.name}.nc"
    if not record.exists():
        for place in places:
            shutil.rmtree(place, ignore_errors=True)
        committed = folder / "sealed", folder / "commitment.json"
        if film:
            own = config()
            watchdog = own["bench"]["watchdog_time"]
            settings = {"acquisition": own["acquisition"], "watchdog_time": watchdog}
            settings["bench"] = _bench()
            trial_acquire(settings, Path(own["trials"]["device"]), *committed, *places)
        else:
            trial_log({"bench": _bench()}, *committed, *places)
    return record


def _bench() -> dict[str, Any]:
    """Return the settings that say around what the trials are drawn."""
    return plain_settings(BENCH, read_bench(BENCH))


def posed(file: Path) -> Posed:
    """Return the task that the record of a trial sets, from the record alone."""
    dataset = store.read_record(file)
    own = config()
    leaves = {key: own[key] for key in ("seed", "discrepancy")} | {"system": file.stem}
    simulation = load_simulation(dataset.attrs["simulation"])
    signals = store.signals(dataset)
    return Posed.of(file.stem, signals, KEPT_BACK, simulation, Settings.of(leaves))


def label(drawn: Drawn) -> trials.Label:
    """Open the seal of a trial."""
    file = drawn.folder / "sealed" / f"{drawn.name}.json"
    trials.open_seal(file, drawn.public["sha256"])
    return trials.Label.of(Trial.read(file).label())
