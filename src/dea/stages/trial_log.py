"""Record the devices of a batch of blind trials that have a data logger of their own."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trial_log(
    settings: Mapping[str, Any], sealed: Path, commitment: Path, logs: Path, log_truth: Path
) -> None:  # fmt: skip
    """Write ``logs/NNNN.nc`` for each trial of another device than the film, and the truth.

    ``log_truth/NNNN.npy`` holds the readings without noise, in the record's unit. ``settings``
    hold the ``bench``; all else that is played stands in the sealed files.
    """
    import json

    import numpy as np
    import xarray as xr

    from dea import store
    from dea.excitation import design
    from dea.plant import Trial
    from dea.stages.bench_process import plain_as_planned

    bench = plain_as_planned(settings["bench"])
    for folder in (logs, log_truth):
        folder.mkdir(parents=True)
    for name, committed in json.loads(commitment.read_text()).items():
        if committed["device"] == "film":
            continue
        trial = Trial.read(sealed / f"{name}.json")
        volts = design(**committed["excitation"])
        readings, truth = trial.readings(bench, volts)
        time = np.arange(volts.size) / trial.sampling_rate
        record = xr.Dataset(
            {
                "input": store.variable("time", volts, "V", "command"),
                "output": store.variable("time", readings, trial.kind.unit, "reading"),
            },
            coords={"time": store.variable("time", time, "s", "time since the start")},
            attrs={"contract": "imported_record", "simulation": committed["simulation"]},
        )
        store.write(
            record,
            logs / f"{name}.nc",
            title=f"Record of blind trial {name}",
            settings={"excitation": committed["excitation"], **settings},
        )
        np.save(log_truth / f"{name}.npy", truth)


if __name__ == "__main__":
    run(
        trial_log,
        inputs=("sealed", "commitment"),
        outputs=("logs", "log_truth"),
    )
