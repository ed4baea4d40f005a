"""Leave one explanation, by designed records: ``python -m dea.stages.resolve --help``."""

import argparse
import hashlib
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dea import acquisition, modbus, resolution, store
from dea.audit import withdraw
from dea.configuration.acquisition import Actuator
from dea.configuration.bench import BENCH, VirtualBench, read_bench
from dea.configuration.case import Case, is_designed, read_cases, simulation_of
from dea.configuration.files import read_text_and_yaml
from dea.configuration.named_files import check_actuators
from dea.configuration.problems import did_you_mean
from dea.configuration.study import FILE, Study, check_study
from dea.configuration.study import settings as written
from dea.discrepancy import Settings
from dea.errors import InputError
from dea.progress import heard_by, part_of
from dea.provenance import RESULTS
from dea.resolution import CERTIFICATE, ByHand, Options, Resolution, record_key
from dea.simulation import Simulation, files_read, load_simulation
from dea.stages.driven import Driven

if TYPE_CHECKING:
    import xarray as xr

CASES = Path("config/cases")


class _Files(NamedTuple):
    """Folder of a resolution, file of the first record, and folder of those handed in later."""

    folder: Path
    first: Path
    further: Path


class _Question(NamedTuple):
    """The simulation that is asked about, and how.

    ``leaves`` are those of the configuration that shape the answer, ``follows_from`` what the
    designs follow from besides limits and records.
    """

    leaves: dict[str, Any]
    simulation: Simulation
    settings: Settings
    options: Options
    follows_from: dict[str, Any]


class _System(NamedTuple):
    """An actuator or case: its question, its records, and the source of designed ones.

    ``given`` are the files of the records after the first.
    """

    question: _Question
    records: "list[xr.Dataset]"
    given: dict[str, Path]
    source: Driven | ByHand


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
    if name not in actuators and name not in cases:
        raise _no_such(name, [*actuators, *cases])
    first = results / name / "record.nc"
    if not first.exists():
        raise InputError("there is no record", file=first, remedy=f"Make it: make {first}")
    files = _Files(results / "resolve" / name, first, first.with_name("further"))
    system = (
        _of_actuator(actuators[name], files, study, config, bench, operator)
        if name in actuators
        else _of_case(name, cases[name], files, study)
    )
    withdraw()
    _withdraw_found(system.source)
    question = system.question
    found = resolution.resolve(
        system.records, question.simulation, system.source, system.source.limits,
        settings=question.settings, options=question.options, workers=threads,
    )  # fmt: skip
    # First of all: a page that is left from before may ask for an excitation that no limit allows.
    system.source.finish(found)
    _write(found, name, system)
    _draw(files.folder, study.figures.resolution)
    _tabulate(files.folder.parent)
    return found


def _of_actuator(
    actuator: Actuator,
    files: _Files,
    study: Study,
    config: str,
    bench: VirtualBench,
    operator: str,
) -> _System:
    device = modbus.read_device(Path(actuator.device))
    if actuator.bench is None:
        acquisition.refuse_unarmed(device, operator or study.acquisition.armed_by)
    record = _first_record(files, study)
    question = _question(study, actuator.name, study.discrepancy.simulation, {})
    described = hashlib.sha256(device.described.encode()).hexdigest()
    source = Driven(
        files.folder, files.first, resolution.allowed_by_device(study, device, record),
        question.follows_from | {"device": described},
        study, config, bench, actuator, device, operator,
    )  # fmt: skip
    return _System(question, [record], {}, source)


def _of_case(name: str, case: Case, files: _Files, study: Study) -> _System:
    record, case_file = _first_record(files, study), CASES / f"{name}.yaml"
    named = simulation_of(case, case_file)
    keys = [key for key in case.records if not is_designed(key)]
    given = {key: files.further / f"{key}.nc" for key in keys}
    records = [record, *map(store.read_record, given.values())]
    question = _question(study, name, named, written(case.split) if case.split else {})
    source = ByHand(
        files.folder, files.first, resolution.allowed_by_records(study, records),
        question.follows_from, files.further, case, case_file,
    )  # fmt: skip
    source.check_keys()
    return _System(question, records, given, source)


def _first_record(files: _Files, study: Study) -> "xr.Dataset":
    """Return the part of the first record that is begun from."""
    return store.read_record(files.first).isel(time=slice(study.resolution.first))


def _question(study: Study, name: str, simulation: str, split: dict[str, Any]) -> _Question:
    """Return what is asked of the actuator or case ``name``, by the ``split`` of a case."""
    leaves = written(study) | {"system": name, "split": split}
    options = Options(
        study.resolution.records,
        study.resolution.duration,
        study.resolution.level,
        study.resolution.another,
    )
    loaded, files = _simulation(simulation)
    settings = Settings.of(leaves)
    follows_from = {
        "options": asdict(options),
        "settings": asdict(settings),
        "simulation": files,
    }
    return _Question(leaves, loaded, settings, options, follows_from)


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


def _write(found: Resolution, name: str, system: _System) -> None:
    """Write the dataset, with every record that it rests on."""
    question, source = system.question, system.source
    driven = [each.number for each in found.rounds]
    driven += [CERTIFICATE] if found.certificate else []
    store.write(
        resolution.resolution_dataset(found, question.options.level),
        source.folder / "resolution.nc",
        title=f"Explanations of {name}, round by round",
        inputs={
            "record": source.first,
            **system.given,
            **{record_key(number): source.file(number) for number in driven},
        },
        settings=question.leaves,
        seed=question.settings.seed,
    )


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
