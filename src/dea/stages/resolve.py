"""Leave one explanation, by designed records: ``python -m dea.stages.resolve --help``."""

import argparse
import hashlib
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from dea import acquisition, modbus, resolution, store
from dea.audit import withdraw
from dea.configuration.bench import BENCH, read_bench
from dea.configuration.case import is_designed, read_cases, simulation_of
from dea.configuration.files import read_text_and_yaml
from dea.configuration.named_files import check_actuators
from dea.configuration.problems import did_you_mean
from dea.configuration.study import FILE, check_study
from dea.configuration.study import settings as written
from dea.discrepancy import Settings
from dea.errors import InputError
from dea.progress import heard_by, part_of
from dea.provenance import RESULTS
from dea.resolution import CERTIFICATE, ByHand, Options, Resolution, record_key
from dea.simulation import Simulation, files_read, load_simulation
from dea.stages.driven import Driven

CASES = Path("config/cases")


def resolve(name: str, operator: str, threads: int, results: Path = RESULTS) -> Resolution:
    """Resolve the diagnosis of an actuator or case by designed records.

    Raises
    ------
    InputError, DeviceError
        As the acquisition does; also where there is no record to begin from, or what is kept
        belongs to another one.
    """
    config, content = read_text_and_yaml(FILE, what="the configuration", example=FILE)
    study = check_study(content)
    bench = read_bench(BENCH)
    check_actuators(study, list(bench.actuators), BENCH)
    cases = {file.stem: case for file, case in read_cases(CASES, study).items()}
    actuators = {actuator.name: actuator for actuator in study.actuators}
    folder, further = results / "resolve" / name, results / name / "further"
    first = results / name / "record.nc"
    if name not in actuators and name not in cases:
        raise _no_such(name, [*actuators, *cases])
    if not first.exists():
        raise InputError("there is no record", file=first, remedy=f"Make it: make {first}")
    device = modbus.read_device(Path(actuators[name].device)) if name in actuators else None
    if device is not None and actuators[name].bench is None:
        acquisition.refuse_unarmed(device, operator or study.acquisition.armed_by)
    records = [store.read_record(first).isel(time=slice(study.resolution.first))]
    leaves = written(study) | {"system": name, "split": {}}
    named = study.discrepancy.simulation
    given: list[str] = []
    options = Options(
        study.resolution.records,
        study.resolution.duration,
        study.resolution.level,
        study.resolution.another,
    )
    if device is None:
        case = cases[name]
        named = simulation_of(case, CASES / f"{name}.yaml")
        leaves["split"] = written(case.split) if case.split else {}
        given = [key for key in case.records if not is_designed(key)]
        records += [store.read_record(further / f"{key}.nc") for key in given]
    simulation, files = _simulation(named)
    settings = Settings.of(leaves)
    asked: dict[str, Any] = {
        "options": asdict(options),
        "settings": asdict(settings),
        "simulation": files,
    }
    source: Driven | ByHand
    if device is not None:
        limits = resolution.allowed_by_device(study, device, records[0])
        asked["device"] = hashlib.sha256(device.described.encode()).hexdigest()
        source = Driven(
            folder, first, limits, asked, study, config, bench, actuators[name], device, operator
        )
    else:
        limits = resolution.allowed_by_records(study, records)
        source = ByHand(folder, first, limits, asked, further, case, CASES / f"{name}.yaml")
        source.check_keys()
    withdraw()
    _withdraw_found(source)
    found = resolution.resolve(
        records, simulation, source, limits,
        settings=settings, options=options, workers=threads,
    )  # fmt: skip
    # First of all: a page that is left from before may ask for an excitation that no limit allows.
    source.finish(found)
    driven = [each.number for each in found.rounds]
    driven += [CERTIFICATE] if found.certificate else []
    store.write(
        resolution.resolution_dataset(found, options.level),
        folder / "resolution.nc",
        title=f"Explanations of {name}, round by round",
        inputs={
            "record": first,
            **{key: further / f"{key}.nc" for key in given},
            **{record_key(number): source.file(number) for number in driven},
        },
        settings=leaves,
        seed=study.seed,
    )
    _draw(folder, study.figures.resolution)
    _tabulate(folder.parent)
    return found


def _simulation(named: str) -> tuple[Simulation, dict[str, Any]]:
    """Return a simulation, and its name with the SHA-256 of each file of a user's it rests on."""
    with files_read() as read:
        found = load_simulation(named)
    files = {Path(found.source), *read} if found.source else read
    return found, {"name": named, "files": {str(file): store.sha256(file) for file in files}}


def _withdraw_found(source: Driven | ByHand) -> None:
    """Remove what an earlier run has found, which one that fails must not leave as its own."""
    for pattern in ("resolution.nc", "probability.*"):
        for file in source.folder.glob(pattern):
            file.unlink()
    source.withdraw()
    _tabulate(source.folder.parent)


def _draw(folder: Path, dots_per_inch: int) -> None:
    """Draw the figure of a system."""
    from dea.figures import style
    from dea.figures.resolution import resolution as drawn

    paths = [folder / f"probability.{kind}" for kind in ("png", "pdf")]
    found = store.read(folder / "resolution.nc")
    style.save(drawn(found, folder.name), paths, dots_per_inch)


def _tabulate(folder: Path) -> None:
    """Write the table of all systems that were resolved; where none was, there is none."""
    from dea.tables.resolution import resolution as tabulated
    from dea.tables.table import save

    files = [folder / f"rounds.{kind}" for kind in ("csv", "md", "tex")]
    every = store.Sources(sorted(folder.glob("*/resolution.nc"))).datasets("resolution")
    if every:
        save(tabulated(every), *files)
        return
    for file in files:
        file.unlink(missing_ok=True)


def _no_such(name: str, known: Sequence[str]) -> InputError:
    return InputError(
        f"there is no actuator or case {name!r}",
        file=FILE,
        field="actuators",
        remedy=f"{did_you_mean(name, known)}There are {', '.join(known)}.",
    )


def _show(step: str) -> None:
    """Show the last step on a terminal."""
    if sys.stderr.isatty():
        print(f"\r\033[K{step}", end="", file=sys.stderr, flush=True)


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; exits as :func:`dea.acquisition.reported`."""
    parser = argparse.ArgumentParser(prog="python -m dea.stages.resolve", description=__doc__)
    parser.add_argument("name", nargs="+", help="actuators of config/config.yaml, or cases")
    parser.add_argument(
        "--operator", default="", help="your name: you have checked the setup and arm the device"
    )
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args(arguments)
    with acquisition.reported("ended; the same command goes on from the records that there are"):
        for name in options.name:
            try:
                with heard_by(_show), part_of(name):
                    found = resolve(name, options.operator, options.threads)
            finally:
                _show("")
            print(resolution.said(name, found))


if __name__ == "__main__":
    main()
