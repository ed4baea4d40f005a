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
        As :func:`dea.stages.bench_process.as_planned`.
    """
    from dea import acquisition, modbus
    from dea.stages.bench_process import as_planned, bench_process
    from dea.stages.driving import excitation, write

    description = modbus.read_device(device)
    options = acquisition.AcquisitionSettings.from_mapping(settings["acquisition"])
    played = excitation(settings, description)
    bench = as_planned(settings["bench"])
    # Named as what the next run of this job removes: a virtual actuator can be driven again.
    partial = record.with_name(f".{record.name}.samples.partial")
    with bench_process(**bench, device=device, seed=played.noise_seed) as answering:
        acquired = played.label(acquisition.acquire(answering, played.volts, partial, options))
    write(acquired, {"record": record, "link": link}, settings)
    partial.unlink()


if __name__ == "__main__":
    run(acquire, inputs=("device",), outputs=("record", "link"))
