"""Designed records of an actuator that is driven over Modbus, virtual or not."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dea import acquisition, archive, modbus, seeds, store
from dea.configuration.acquisition import Actuator
from dea.configuration.bench import BENCH, VirtualBench, served_settings
from dea.configuration.case import designed
from dea.configuration.study import Study
from dea.configuration.study import settings as written
from dea.resolution import Kept, Resolution

if TYPE_CHECKING:
    import xarray as xr


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
