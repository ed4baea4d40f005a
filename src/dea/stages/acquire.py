"""Drive an actuator with its excitation over Modbus and keep what it applied and measured."""

from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from dea.stages.command import run


def acquire(settings: Mapping[str, Any], device: Path, record: Path, link: Path) -> None:
    """Acquire one record.

    ``settings`` holds ``seed``, ``system``, ``excitation``, ``excitation_name``, ``acquisition``
    and, where a virtual actuator is to answer, ``bench`` with ``actuator``, ``config`` and
    ``watchdog_time``; otherwise the device answers at the endpoint of its description.
    """
    from dataclasses import replace

    from dea import acquisition, modbus, seeds, store
    from dea.errors import InputError
    from dea.excitation import design
    from dea.stages.bench_process import bench_process

    description = modbus.read_device(device)
    options = acquisition.AcquisitionSettings.from_mapping(settings["acquisition"])
    job = seeds.generator(settings["seed"], settings["system"], settings["excitation_name"])
    excitation_seed, noise_seed = (int(number) for number in job.integers(2**31, size=2))
    volts = design(
        **settings["excitation"],
        sampling_rate=description.sampling_rate,
        seed=excitation_seed,
    )
    try:
        acquisition.check_excitation(description, volts)
    except InputError as error:
        raise InputError(
            error.problem,
            file="config/config.yaml",
            field=f"excitation.{settings['excitation_name']}.low, high",
            remedy=f"Narrow it there, or widen {error.field} in {device} if film and amplifier"
            " bear it.",
        ) from error
    bench = settings.get("bench")
    process = (
        bench_process(**bench, device=device, seed=noise_seed) if bench else nullcontext()
    )  # fmt: skip
    partial = record.with_suffix(".partial")
    with process as port:
        answering = replace(description, host="127.0.0.1", port=port) if port else description
        acquired = acquisition.acquire(answering, volts, partial, options)
    inputs = {"device": device} | ({"bench": bench["config"]} if bench else {})
    for dataset, path, contract in (
        (acquired.link, link, "link"),
        (acquired.record, record, "record"),
    ):
        store.write(
            dataset.assign_attrs(contract=contract, device_description=device.read_text()),
            path,
            title=f"{contract.capitalize()} of {settings['system']}: {settings['excitation_name']}",
            inputs=inputs,
            settings=settings,
            seed=settings["seed"],
        )
    partial.unlink()


if __name__ == "__main__":
    run(acquire, inputs=("device",), outputs=("record", "link"))
