"""Drive and record the actuators of a batch of blind trials over Modbus."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trial_acquire(
    settings: Mapping[str, Any],
    device: Path,
    sealed: Path,
    commitment: Path,
    records: Path,
    truth: Path,
) -> None:
    """Write ``records/NNNN.nc`` for each trial of a film, and ``truth/NNNN.npy``.

    The sealed files go to the bench's own process alone, which writes the truth: every reading
    without noise since the bench's start (mm). This process knows the excitation. ``settings``
    holds ``acquisition``, ``watchdog_time`` and ``bench``.
    """
    import json
    from dataclasses import replace

    from dea import acquisition, store
    from dea.excitation import design
    from dea.stages.bench_process import plain_as_planned, trial_process

    bench = plain_as_planned(settings["bench"])
    options = acquisition.AcquisitionSettings.from_mapping(settings["acquisition"])
    for folder in (records, truth):
        folder.mkdir(parents=True)
    for name, trial in json.loads(commitment.read_text()).items():
        if trial["device"] != "film":
            continue
        volts = design(**trial["excitation"])
        partial = records / f"{name}.partial"
        with trial_process(
            sealed / f"{name}.json",
            truth=truth / f"{name}.npy",
            config=bench,
            device=device,
            watchdog_time=settings["watchdog_time"],
        ) as answering:
            sampled = replace(answering, sampling_rate=trial["excitation"]["sampling_rate"])
            acquired = acquisition.acquire(sampled, volts, partial, options)
        store.write(
            acquired.record.assign_attrs(contract="record", simulation=trial["simulation"]),
            records / f"{name}.nc",
            title=f"Record of blind trial {name}",
            inputs={"device": device},
            settings={"excitation": trial["excitation"], **settings},
        )
        partial.unlink()


if __name__ == "__main__":
    run(
        trial_acquire,
        inputs=("device", "sealed", "commitment"),
        outputs=("records", "truth"),
    )
