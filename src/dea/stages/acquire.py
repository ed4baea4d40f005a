"""Drive a virtual actuator over Modbus and keep what it applied and measured."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def acquire(settings: Mapping[str, Any], device: Path, record: Path, link: Path) -> None:
    """Acquire one record.

    ``settings`` holds those of :func:`dea.stages.driving.excitation`, ``acquisition`` and
    ``bench`` with ``actuator``, ``config`` and ``watchdog_time``.
    """
    from dataclasses import replace

    from dea import acquisition, modbus
    from dea.stages.bench_process import bench_process
    from dea.stages.driving import excitation, write

    description = modbus.read_device(device)
    options = acquisition.AcquisitionSettings.from_mapping(settings["acquisition"])
    played = excitation(settings, description)
    bench = settings["bench"]
    partial = record.with_suffix(".partial")
    with bench_process(**bench, device=device, seed=played.noise_seed) as port:
        answering = replace(description, host="127.0.0.1", port=port, virtual=True)
        acquired = played.label(acquisition.acquire(answering, played.volts, partial, options))
    inputs = {"device": device, "bench": Path(bench["config"])}
    write(acquired, {"record": record, "link": link}, settings, inputs)
    partial.unlink()


if __name__ == "__main__":
    run(acquire, inputs=("device",), outputs=("record", "link"), named=("bench.config",))
