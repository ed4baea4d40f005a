"""Drive a virtual actuator over Modbus and keep what it applied and measured."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def acquire(settings: Mapping[str, Any], device: Path, record: Path, link: Path) -> None:
    """Acquire one record.

    ``settings`` holds those of :func:`dea.stages.driving.excitation`, ``acquisition`` and
    ``bench`` with ``actuator``, ``config``, ``watchdog_time``, and ``plant``, which is what the
    file ``config`` says of this actuator: an edit of another one is none of this record's.

    Raises
    ------
    InputError
        Where the file says something else than ``plant``.
    """
    from dataclasses import replace

    from dea import acquisition, modbus
    from dea.configuration.bench import read_bench
    from dea.errors import InputError
    from dea.stages.bench_process import bench_process
    from dea.stages.driving import excitation, write

    description = modbus.read_device(device)
    options = acquisition.AcquisitionSettings.from_mapping(settings["acquisition"])
    played = excitation(settings, description)
    bench = dict(settings["bench"])
    actuator, plant = bench["actuator"], bench.pop("plant")
    if read_bench(bench["config"]).actuators[actuator].model_dump() != plant:
        raise InputError(
            "has changed since this run was planned",
            file=bench["config"],
            field=f"actuators.{actuator}",
            remedy="Run again.",
        )
    # Named as what the next run of this job removes: a virtual actuator can be driven again.
    partial = record.with_name(f".{record.name}.samples.partial")
    with bench_process(**bench, device=device, seed=played.noise_seed) as port:
        answering = replace(description, host="127.0.0.1", port=port, virtual=True)
        acquired = played.label(acquisition.acquire(answering, played.volts, partial, options))
    write(acquired, {"record": record, "link": link}, settings, {"device": device})
    partial.unlink()


if __name__ == "__main__":
    run(acquire, inputs=("device",), outputs=("record", "link"))
