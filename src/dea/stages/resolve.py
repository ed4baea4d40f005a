"""Leave one explanation, by designed records: ``python -m dea.stages.resolve --help``."""

import argparse
import hashlib
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dea import acquisition, archive, modbus, resolution, seeds, store
from dea.audit import withdraw
from dea.configuration.acquisition import Actuator
from dea.configuration.bench import BENCH, VirtualBench, read_bench, served_settings
from dea.configuration.case import designed, is_designed, read_cases, simulation_of
from dea.configuration.files import read_text_and_yaml
from dea.configuration.named_files import check_actuators
from dea.configuration.problems import did_you_mean
from dea.configuration.study import FILE, Study, check_study
from dea.configuration.study import settings as written
from dea.discrepancy import Settings
from dea.errors import InputError
from dea.progress import heard_by, part_of
from dea.provenance import RESULTS
from dea.resolution import CERTIFICATE, ByHand, Kept, Limits, Options, Resolution, record_key
from dea.simulation import Simulation, files_read, load_simulation

if TYPE_CHECKING:
    import xarray as xr

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
        limits = _of_device(study, device, records[0])
        asked["device"] = hashlib.sha256(device.described.encode()).hexdigest()
        source = Driven(
            folder, first, limits, asked, study, config, bench, actuators[name], device, operator
        )
    else:
        limits = _of_records(study, records)
        source = ByHand(folder, first, limits, asked, further, case, CASES / f"{name}.yaml")
        source.check_keys()
    withdraw()
    _withdraw_found(folder)
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


def _withdraw_found(folder: Path) -> None:
    """Remove what an earlier run has found, which one that fails must not leave as its own."""
    of_round = ("verdict.json", "posterior.json", "extended_simulation.yaml")
    found = ("resolution.nc", "probability.*", *(f"*/{name}" for name in of_round))
    for pattern in found:
        for file in folder.glob(pattern):
            file.unlink()
    _tabulate(folder.parent)


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


def _of_device(study: Study, device: modbus.Device, record: "xr.Dataset") -> Limits:
    """Return what the excitations of the study, the device and its first record allow."""
    own = _of_records(study, [record])
    played = study.excitation.record
    of_device = device.safety.max_rate if device.safety else None
    given = [each for each in (study.resolution.rate, of_device) if each]
    rate = min(given, default=own.rate)
    return Limits(
        played.low, played.high, rate, own.output_low, own.output_high, device.sampling_rate
    )


def _of_records(study: Study, records: "list[xr.Dataset]") -> Limits:
    """Return what the records of a device allow, at the rate of the study if it gives one."""
    signals = [store.signals(record) for record in records]
    return Limits.of(signals, study.resolution.output_margin, study.resolution.rate)


@dataclass
class Driven(Kept):
    """An actuator that is driven over Modbus, virtual or not.

    ``config`` is the text that the study was read from, ``bench`` the virtual actuators as they
    were then.
    """

    study: Study
    config: str
    bench: VirtualBench
    actuator: Actuator
    device: modbus.Device
    operator: str

    def file(self, number: int) -> Path:
        """Return the file of a record, beside its design."""
        return self.folder_of(number) / "record.nc"

    def recorded(self, number: int) -> bool:
        """Return whether it has been driven."""
        if self.file(number).exists():
            return True
        return not self.actuator.bench and bool(self._archived(self._settings(number)))

    def record(self, number: int, u: np.ndarray) -> "xr.Dataset":
        """Return the record of an excitation, which is driven where there is none yet."""
        file = self.file(number)
        if not file.exists():
            acquisition.check_excitation(self.device, u)
            (self._drive if self.actuator.bench else self._archive)(number, u, file)
        return store.read_record(file)

    def finish(self, found: Resolution) -> None:
        """Leave nothing to be done by hand."""

    def _settings(self, number: int) -> dict[str, Any]:
        return {
            "seed": self.study.seed,
            "system": self.actuator.name,
            "excitation_name": designed(number),
            "excitation_sha256": store.sha256(self.folder_of(number) / "excitation.csv"),
            "first_record": self.first_digest(),
            "acquisition": written(self.study.acquisition),
        }

    def _drive(self, number: int, u: np.ndarray, file: Path) -> None:
        """Drive a virtual actuator as the study does.

        Raises
        ------
        InputError
            As :func:`dea.stages.bench_process.as_planned`.
        """
        from dea.stages.bench_process import as_planned, bench_process
        from dea.stages.driving import write

        settings = self._settings(number)
        job = seeds.generator(self.study.seed, self.actuator.name, settings["excitation_name"])
        options = acquisition.AcquisitionSettings.from_mapping(settings["acquisition"])
        partial = file.with_name(".samples.partial")
        served = str(self.actuator.bench)
        planned = served_settings(written(self.study.bench), served, BENCH, self.bench)
        with bench_process(
            **as_planned(planned),
            device=Path(self.actuator.device),
            seed=int(job.integers(2**31)),
        ) as answering:
            acquired = acquisition.acquire(answering, u, partial, options)
        files = {"link": file.with_name("link.nc"), "record": file}
        write(acquired, files, settings, {"excitation": file.parent / "excitation.csv"})
        partial.unlink()

    def _archive(self, number: int, u: np.ndarray, file: Path) -> None:
        """Drive hardware as `make record` does; a record that was kept before is taken."""
        import xarray as xr

        from dea.stages.driving import PlayedExcitation
        from dea.stages.record import keep
        from dea.stages.take_record import take_record

        settings = self._settings(number)
        kept = self._archived(settings)
        played = PlayedExcitation(u, 0, xr.Dataset())
        if kept:
            folder = kept[-1]
        else:
            folder = keep(self.device, played, settings, self.operator, self.config)
        take_record(settings, folder / archive.MANIFEST, file, file.with_name("link.nc"))

    def _archived(self, settings: Mapping[str, Any]) -> list[Path]:
        """Return the folders of the records that this excitation and first record led to."""
        folders = archive.finished(self.actuator.name, settings["excitation_name"])
        kept = [(folder, archive.manifest(folder)) for folder in folders]
        return [
            folder
            for folder, content in kept
            if archive.FAULT not in content
            and content["settings"].get("excitation_sha256") == settings["excitation_sha256"]
            and self.is_first(content["settings"].get("first_record"))
        ]


def said(name: str, found: Resolution) -> str:
    """Return what a resolution found in a few lines."""
    verdict, count = found.last.verdict, len(found.rounds)
    records = f"{count} designed record{'s' * (count != 1)}"
    lines = [
        f"{name}: {verdict.sentence}",
        f"{found.outcome}: {records}, {found.last.driven:g} s driven.",
    ]
    if found.certificate:
        before, after = found.certificate.before, found.certificate.after
        lines.append(f"On a fresh record: error {before:.3g} to {after:.3g} {verdict.unit}.")
    if found.halted:
        lines.append(found.halted)
    if found.pending is not None:
        lines.append(f"Next: {RESULTS / 'resolve' / name / 'next_experiment.md'}")
    return "\n".join(lines)


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
            print(said(name, found))


if __name__ == "__main__":
    main()
