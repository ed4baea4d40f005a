"""What the jobs that drive an actuator share: the voltage they play, and the files they write."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dea import acquisition, seeds, store
from dea.errors import InputError
from dea.excitation import design
from dea.modbus import Device


class Excitation(NamedTuple):
    """Volts, one per sample period, and the seed of the noise of an actuator that is virtual."""

    volts: np.ndarray
    noise_seed: int


def excitation(settings: Mapping[str, Any], device: Device) -> Excitation:
    """Design the voltage of a job.

    ``settings`` holds ``seed``, ``system``, ``excitation`` and ``excitation_name``.

    Raises
    ------
    InputError
        Where it leaves the limits of ``device``, or the excitation's own settings are wrong.
    """
    job = seeds.generator(settings["seed"], settings["system"], settings["excitation_name"])
    excitation_seed, noise_seed = (int(number) for number in job.integers(2**31, size=2))
    volts = design(
        **settings["excitation"], sampling_rate=device.sampling_rate, seed=excitation_seed
    )
    try:
        acquisition.check_excitation(device, volts)
    except InputError as error:
        raise InputError(
            error.problem,
            file="config/config.yaml",
            field=f"excitation.{settings['excitation_name']}.low, high",
            remedy=f"Narrow it there, or widen {error.field} in {device.source} if film and"
            " amplifier bear it.",
        ) from error
    return Excitation(volts, noise_seed)


def write(
    acquired: acquisition.Acquisition,
    files: Mapping[str, Path],
    settings: Mapping[str, Any],
    inputs: Mapping[str, Path],
) -> None:
    """Write what was acquired to ``files``, by contract: ``record`` and ``link``.

    ``settings`` are those of :func:`excitation`; ``inputs`` hold the description, ``device``.
    """
    for contract, dataset in (("link", acquired.link), ("record", acquired.record)):
        description = inputs["device"].read_text()
        store.write(
            dataset.assign_attrs(contract=contract, device_description=description),
            files[contract],
            title=f"{contract.capitalize()} of {settings['system']}: {settings['excitation_name']}",
            inputs=inputs,
            settings=settings,
            seed=settings["seed"],
        )
