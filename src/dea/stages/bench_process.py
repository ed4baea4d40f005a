"""A virtual actuator in a process of its own, for as long as it is needed."""

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dea.errors import InputError

if TYPE_CHECKING:
    from dea.modbus import Device


def as_planned(bench: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings ``bench`` of a stage as :func:`bench_process` takes them.

    Raises
    ------
    InputError
        Where the bench's file says something else of the actuator than their ``plant`` does.
    """
    from dea.configuration.bench import read_bench

    served = dict(bench)
    actuator, plant = served["actuator"], served.pop("plant")
    if read_bench(served["config"]).actuators[actuator].model_dump() != plant:
        raise _changed(served["config"], f"actuators.{actuator}")
    return served


def plain_as_planned(bench: Mapping[str, Any]) -> Path:
    """Return the file of the bench whose plain actuator the blind trials are drawn around.

    Raises
    ------
    InputError
        Where it says something else of that actuator than ``plain`` in the settings ``bench``.
    """
    from dea.configuration.bench import plain_settings, read_bench

    file = Path(bench["config"])
    if plain_settings(file, read_bench(file)) != bench:
        raise _changed(file, "plain")
    return file


def _changed(file: str | Path, field: str) -> InputError:
    return InputError(
        "has changed since this run was planned", file=file, field=field, remedy="Run again."
    )


@contextmanager
def bench_process(
    actuator: str, *, config: Path, device: Path, seed: int, watchdog_time: float
) -> Iterator["Device"]:
    """Yield the ``device`` as ``actuator`` of ``config`` answers, at a free loopback port.

    Its clock is virtual: it plays as fast as samples arrive. The process ends with the block, or
    when this process ends.

    Raises
    ------
    InputError
        Where the bench does not start; its own message has gone to standard error.
    """
    served = ["--actuator", actuator, "--seed", str(seed)]
    with _serving(served, f"the bench of {actuator}", config, device, watchdog_time) as answering:
        yield answering


@contextmanager
def trial_process(
    sealed: Path, *, truth: Path, config: Path, device: Path, watchdog_time: float
) -> Iterator["Device"]:
    """Yield the ``device`` as the actuator of a blind trial answers, as :func:`bench_process`.

    When it ends it writes its readings without noise to ``truth`` (NumPy, mm, since its start).
    """
    name = f"the bench of trial {sealed.stem}"
    served = ["--trial", str(sealed), "--truth", str(truth)]
    with _serving(served, name, config, device, watchdog_time) as answering:
        yield answering


@contextmanager
def _serving(
    served: list[str], name: str, config: Path, device: Path, watchdog_time: float
) -> Iterator["Device"]:
    from dea.modbus import read_device

    command = [
        sys.executable, "-m", "dea.bench", *served, "--config", str(config),
        "--device", str(device), "--host", "127.0.0.1", "--port", "0", "--clock", "virtual",
        "--watchdog", str(watchdog_time), "--until-stdin-closes",
    ]  # fmt: skip
    with subprocess.Popen(
        # Its session is its own, so that Ctrl-C does not end it before the guardian.
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None
        try:
            address = process.stdout.readline()
            if not address:
                raise InputError(
                    f"{name} does not start", file=config, remedy="See its message above."
                )
            port = json.loads(address)["port"]
            yield replace(read_device(device), host="127.0.0.1", port=port, virtual=True)
        finally:
            process.terminate()
