"""Speed of the acquisition against bare Modbus calls and the plant's physics, and its lateness.

``python -m benchmarks.acquisition --soak`` polls for ten minutes at wall time, twice: with the
machine idle, and with one core kept busy; ``--store`` keeps the lateness for the documents.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pymodbus.client import ModbusTcpClient

from benchmarks import command_line
from benchmarks.row import HEAD, Row
from benchmarks.stored import command, store
from dea.acquisition import AcquiredRecord, AcquisitionSettings, acquire
from dea.arrays import Array
from dea.modbus import Command, Device, encode, read_device, to_counts
from dea.plant import Rig

ROOT = Path(__file__).parents[1]
CONFIG, DESCRIPTION = ROOT / "config/bench.yaml", ROOT / "config/devices/virtual_bench.yaml"
POLLED_SAMPLES, BUFFERED_SAMPLES, REPEATS = 4000, 90_000, 3
IN_BENCHMARK, IN_SOAK = 30.0, 600.0  # s at wall time


def run(peers_python: Path | None = None) -> list[Row]:
    """Return rows for polled speed, buffered speed and lateness; ``peers_python`` is not used."""
    found = lateness(IN_BENCHMARK, busy=False)
    return [polled_speed(), buffered_speed(), punctuality(found, IN_BENCHMARK, busy=False)]


def polled_speed() -> Row:
    """Compare samples driven one by one with the bare pymodbus call on the same registers."""
    volts = _volts(POLLED_SAMPLES)
    settings = AcquisitionSettings(mode="polled", ramp_rate=100.0, paced=False)
    with _bench("virtual") as device:
        bare, ours = [], []
        for _ in range(REPEATS):
            bare.append(_bare_round_trips(device, volts))
            ours.append(_seconds(device, volts, settings))
    name = f"{POLLED_SAMPLES} polled samples, against bare function code 23"
    return Row.of_times(name, min(ours), min(bare), 0.8)


def buffered_speed() -> Row:
    """Compare half an hour of samples through the FIFO with simulating the same film directly."""
    volts = _volts(BUFFERED_SAMPLES)
    counts = to_counts(read_device(DESCRIPTION)["output"], volts).astype(np.uint16)
    Rig.from_config(CONFIG, "dea1", seed=0).advance(counts[:1])
    physics, ours = [], []
    for _ in range(REPEATS):
        rig = Rig.from_config(CONFIG, "dea1", seed=0)
        start = time.perf_counter()
        rig.advance(counts)
        physics.append(time.perf_counter() - start)
        with _bench("virtual") as device:
            ours.append(_seconds(device, volts, AcquisitionSettings()))
    name = f"{BUFFERED_SAMPLES} buffered samples, against the bench's physics alone"
    return Row.of_times(name, min(ours), min(physics), 0.5)


class Lateness(NamedTuple):
    """How late the latest sample is and one may be, in s, and the share of those in time."""

    worst: float
    allowed: float
    in_time: float


def lateness(seconds: float, *, busy: bool) -> Lateness:
    """Drive samples at 50 Hz and wall time.

    The bench is driven without its sample index, as a plain module has none, so that a late sample
    is flagged and does not end the record.
    """
    settings = AcquisitionSettings(mode="polled", ramp_rate=2.0)
    with _bench("wall") as device, busy_core() if busy else nullcontext():
        registers = {n: r for n, r in device.registers.items() if n != "device_index"}
        volts = _volts(round(seconds * device.sampling_rate))
        link = _acquire(replace(device, registers=registers), volts, settings).link
    jitter, allowed = link.jitter.values, settings.late_after
    return Lateness(float(jitter.max()), allowed, float(np.mean(jitter <= allowed)))


def punctuality(found: Lateness, seconds: float, *, busy: bool) -> Row:
    """Return the row of the share of samples in time."""
    return Row(
        f"samples in time at 50 Hz, {seconds:g} s, {'a busy core' if busy else 'idle'}",
        ratio=found.in_time,
        target=0.999 if busy else 1.0,
        detail=f"the latest by {1e3 * found.worst:.3g} ms, where {1e3 * found.allowed:g} ms are in "
        "time",
    )


def _volts(samples: int) -> Array:
    volts: Array = 2.4 + 1.2 * np.sin(np.arange(samples) * 0.05)
    return volts


def _seconds(device: Device, volts: Array, settings: AcquisitionSettings) -> float:
    start = time.perf_counter()
    _acquire(device, volts, settings)
    return time.perf_counter() - start


def _acquire(device: Device, volts: Array, settings: AcquisitionSettings) -> AcquiredRecord:
    with tempfile.TemporaryDirectory() as folder:
        return acquire(device, volts, Path(folder, "record.partial"), settings)


def _bare_round_trips(device: Device, volts: Array) -> float:
    """Return the seconds that pymodbus's client needs for the calls that poll the samples."""
    client = ModbusTcpClient(device.host, port=device.port)
    client.connect()  # type: ignore[no-untyped-call]
    output, first, last = device["output"], device["applied_output"], device["device_index"]
    counts = to_counts(output, volts).tolist()
    client.write_registers(device["claim"].address, encode(device["claim"], 1))
    client.write_register(device["command"].address, Command.START)
    start = time.perf_counter()
    for count in counts:
        client.readwrite_registers(
            read_address=first.address, read_count=last.end - first.address,
            write_address=output.address, values=[count], device_id=device.unit_id,
        )  # fmt: skip
    seconds = time.perf_counter() - start
    client.write_register(device["command"].address, Command.STOP)
    while any(client.read_holding_registers(first.address).registers):
        time.sleep(0.01)
    client.write_registers(device["claim"].address, encode(device["claim"], 0))
    client.close()  # type: ignore[no-untyped-call]
    return seconds


@contextmanager
def _bench(clock: str) -> Iterator[Device]:
    """Serve the virtual bench from a process of its own."""
    bench = [
        sys.executable, "-m", "dea.bench", "--actuator", "dea1", "--config", str(CONFIG),
        "--device", str(DESCRIPTION), "--port", "0", "--clock", clock, "--until-stdin-closes",
    ]  # fmt: skip
    with subprocess.Popen(
        bench, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            port = json.loads(process.stdout.readline())["port"]
            yield replace(read_device(DESCRIPTION), port=port)
        finally:
            process.terminate()


@contextmanager
def busy_core() -> Iterator[None]:
    """Keep one core busy."""
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as process:
        try:
            yield
        finally:
            process.kill()


def main(arguments: list[str] | None = None) -> int:
    """Print each row; with ``--soak`` only the lateness, over ten minutes.

    Return 1 where a target is missed, else 0.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks.acquisition", description=__doc__)
    parser.add_argument("--soak", action="store_true", help="ten minutes at wall time, twice")
    command_line.add_store(parser)
    options = parser.parse_args(arguments)
    if options.store and not options.soak:
        parser.error("--store keeps the lateness of --soak")
    if options.soak:
        found = {busy: lateness(IN_SOAK, busy=busy) for busy in (False, True)}
        if options.store:
            values = {
                "busy" if busy else "idle": {"worst_ms": 1e3 * one.worst, "in_time": one.in_time}
                for busy, one in found.items()
            }
            store("soak", command("soak"), {"seconds": IN_SOAK, **values})
        rows = [punctuality(one, IN_SOAK, busy=busy) for busy, one in found.items()]
    else:
        rows = run()
    print("\n".join([HEAD, *(line for row in rows for line in row.lines())]))
    missed = [row.name for row in rows if not row.met]
    if missed:
        print("targets missed: " + "; ".join(missed), file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":
    command_line.run(main)
