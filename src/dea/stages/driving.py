"""What the jobs that drive an actuator share: the voltage they play, and the files they write."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from dea import acquisition, seeds, store
from dea.configuration.excitation import RECORD
from dea.configuration.study import FILE
from dea.errors import InputError
from dea.excitation import design
from dea.modbus import Device
from dea.probing import Probed, Probing


class PlayedExcitation(NamedTuple):
    """Volts, one per sample period, and the seed of the noise of an actuator that is virtual.

    ``labels`` are what a record says of its samples besides, where multisines probe it.
    """

    volts: np.ndarray
    noise_seed: int
    labels: xr.Dataset

    def label(self, acquired: acquisition.AcquiredRecord) -> acquisition.AcquiredRecord:
        """Return what was acquired, its record with the labels."""
        record = acquired.record.assign_attrs(self.labels.attrs)
        of_excitation = acquisition.asked_for(record["quality"].values)
        for name, label in self.labels.items():
            values = np.zeros(of_excitation.size, label.dtype)
            values[of_excitation] = label
            record[name] = "time", values, label.attrs
        return acquired._replace(record=record)


def excitation(settings: Mapping[str, Any], device: Device) -> PlayedExcitation:
    """Design the voltage of a job.

    ``settings`` holds ``seed``, ``system``, ``excitation``, ``excitation_name`` and, where
    multisines are to be put into it, ``probing``.

    Raises
    ------
    InputError
        Where it leaves the limits of ``device``, or the excitation's own settings are wrong.
    """
    name, rate = settings["excitation_name"], device.sampling_rate
    own_seed, noise_seed = _seeds(settings, name)
    labels = xr.Dataset()
    field = f"{name}.low, high"
    if "probing" in settings:
        # The voltages of the record, so that the film has the same history.
        volts = _designed(settings, RECORD, rate, _seeds(settings, RECORD)[0])
        probing = Probing(**settings["probing"])
        probed = probing.place(volts, rate, own_seed)
        volts, field = probed.voltage, "probing.bias, rms"
        labels = _labels(probed, 1.0 / probing.lowest)
    else:
        volts = _designed(settings, name, rate, own_seed)
    try:
        acquisition.check_excitation(device, volts)
    except InputError as error:
        remedy = (
            f"Narrow it there, or widen {error.field} in {device.source} if film and amplifier "
            "bear it."
        )
        raise error.at(file=FILE, field=f"excitation.{field}", remedy=remedy) from error
    return PlayedExcitation(volts, noise_seed, labels)


def _designed(settings: Mapping[str, Any], name: str, rate: float, seed: int) -> np.ndarray:
    try:
        return design(**settings["excitation"], sampling_rate=rate, seed=seed)
    except InputError as error:
        raise error.at(file=FILE, field=f"excitation.{name}.{error.field}") from error


def _seeds(settings: Mapping[str, Any], name: str) -> tuple[int, int]:
    """Return the seeds of the design and of the noise of a job."""
    job = seeds.generator(settings["seed"], settings["system"], name)
    design_seed, noise_seed = job.integers(2**31, size=2)
    return int(design_seed), int(noise_seed)


def _labels(probed: Probed, period: float) -> xr.Dataset:
    """Return which samples are whole periods of which multisine, and how long a period is (s)."""
    meaning = {"probing": "number of the probing stretch", "realisation": "number of the multisine"}
    return xr.Dataset(
        {
            name: store.variable(
                "time",
                getattr(probed, name).astype(np.int16),
                "1",
                f"{long_name}, 0 outside whole periods",
            )
            for name, long_name in meaning.items()
        },
        attrs={"probing_period": period},
    )


def write(
    acquired: acquisition.AcquiredRecord,
    files: Mapping[str, Path],
    settings: Mapping[str, Any],
    inputs: Mapping[str, Path] | None = None,
) -> None:
    """Write what was acquired to ``files``, by contract: ``record`` and ``link``.

    ``settings`` are those of :func:`excitation`; ``inputs`` are files it was made from besides the
    device's description.
    """
    for contract, dataset in (("link", acquired.link), ("record", acquired.record)):
        store.write(
            dataset.assign_attrs(contract=contract),
            files[contract],
            title=f"{contract.capitalize()} of {settings['system']}: {settings['excitation_name']}",
            inputs={"device": dataset.attrs["device_description"].encode(), **(inputs or {})},
            settings=settings,
            seed=settings["seed"],
        )
