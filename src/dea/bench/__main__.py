"""A virtual actuator on the network: ``python -m dea.bench --actuator dea1``.

Prints one JSON line with host, port, unit id and process id on standard output once it listens.
"""

import argparse
import asyncio
import copy
import ipaddress
import json
import logging
import os
import secrets
import signal
import ssl
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from dea.atomic_file import atomic
from dea.bench.device import BenchDevice
from dea.bench.player import OutputLimits, Player
from dea.bench.server import WRITER, BenchServer, serve
from dea.configuration.acquisition import Bench
from dea.configuration.problems import validated
from dea.errors import InputError
from dea.modbus import Device, limit_counts, read_device
from dea.plant import (
    SAMPLE_PERIOD,
    Converter,
    Parameters,
    Rig,
    ServedRig,
    Trial,
    read_parameters,
    read_plain,
)

RAMP_RATE = 5.0  # V/s, of the device's own ramp when it is stopped


def build(
    rig: Rig | ServedRig, parameters: Parameters, description: Device, *, virtual_clock: bool,
    watchdog: float, actuator: str, sample_period: float = SAMPLE_PERIOD,
) -> BenchDevice:  # fmt: skip
    """Put a rig behind the register map of ``description``.

    Raises
    ------
    InputError
        Where the description's sampling rate is not the rig's.
    """
    if abs(description.sampling_rate * sample_period - 1) > 1e-9:
        raise InputError(
            f"{description.sampling_rate:g} Hz", file=description.source, field="sampling_rate",
            remedy=f"The bench samples at {1 / sample_period:g} Hz.",
        )  # fmt: skip
    output, displacement = parameters.output_converter, parameters.displacement_converter
    low, high = limit_counts(description)
    ramp_step = max(1, int(RAMP_RATE * sample_period / output.step))
    player = Player(rig, OutputLimits(low, high, rig.zero_count, ramp_step), watchdog_time=watchdog)
    limits = _volts(output, low), _volts(output, high)
    constants: dict[str, float | int | str] = {
        "identity": "dea-bench",
        "version": 1,
        "actuator": actuator[:16],
        "boot": secrets.randbits(32),
        "device_rate": 1 / sample_period,
        "output_range_low": output.low,
        "output_range_high": output.high,
        "output_low_limit": limits[0],
        "output_high_limit": limits[1],
        "displacement_range_low": displacement.low,
        "displacement_range_high": displacement.high,
        "fifo_length": player.fifo_length,
        "ring_length": player.ring.length,
        "watchdog_time": watchdog,
    }
    return BenchDevice(player, description, constants, virtual_clock=virtual_clock)


def _volts(converter: Converter, count: int) -> float:
    return float(converter.to_values(np.array([count], np.uint16))[0])


def parse(arguments: list[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m dea.bench", description=__doc__)
    served = parser.add_mutually_exclusive_group(required=True)
    served.add_argument("--actuator", help="a name of the bench configuration")
    served.add_argument("--trial", type=Path, help="the sealed file of a blind trial")
    parser.add_argument(
        "--truth", type=Path, help="write a trial's readings without noise here when the bench ends"
    )
    parser.add_argument("--config", type=Path, default=Path("config/bench.yaml"))
    parser.add_argument(
        "--device", type=Path, default=Path("config/devices/virtual_bench.yaml"),
        help="the register map to serve",
    )  # fmt: skip
    parser.add_argument("--host", help="address to listen on instead of the description's")
    parser.add_argument("--port", type=int, help="instead of the description's; 0 takes a free one")
    parser.add_argument(
        "--clock", choices=("wall", "virtual"), default="wall",
        help="play at wall time, or as fast as the master feeds samples",
    )  # fmt: skip
    parser.add_argument("--watchdog", type=float, default=1.0, metavar="S")
    parser.add_argument("--seed", type=int, default=0, help="of an actuator's measurement noise")
    parser.add_argument(
        "--until-stdin-closes", action="store_true", help="end with the process that started this"
    )
    parser.add_argument("--tls-certificate", type=Path)
    parser.add_argument("--tls-key", type=Path)
    parser.add_argument(
        "--tls-client-ca", type=Path,
        help="authority of the masters' certificates, whose roles then decide who may write",
    )  # fmt: skip
    parser.add_argument(
        "--writer", nargs="+", default=[WRITER], metavar="ROLE", help="roles that may write"
    )
    return parser.parse_args(arguments)


def main(arguments: list[str] | None = None) -> None:
    """Serve until SIGINT or SIGTERM."""
    options = parse(arguments)
    logging.getLogger("pymodbus").setLevel(logging.CRITICAL)
    try:
        server = _server(options)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    if not _is_loopback(server.host) and options.tls_client_ca is None:
        print(
            f"warning: {server.host} can be reached from the network, and Modbus has no "
            "authentication: anyone there can drive this bench",
            file=sys.stderr,
        )
    try:
        asyncio.run(_run(server, options.until_stdin_closes))
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(1) from None
    finally:
        plant = server.device.player.plant
        if options.truth is not None and isinstance(plant, ServedRig):
            with atomic(options.truth) as partial, partial.open("wb") as file:
                np.save(file, plant.truth)


def _server(options: argparse.Namespace) -> BenchServer:
    description = read_device(options.device).at(options.host, options.port)
    validated(Bench, {"watchdog_time": options.watchdog})
    if options.trial is not None:
        trial = Trial.read(options.trial)
        name, parameters = trial.name, read_plain(options.config)
        rig: Rig | ServedRig = trial.served(options.config)
        description = replace(description, sampling_rate=trial.sampling_rate)
    else:
        name, parameters = options.actuator, read_parameters(options.config, options.actuator)
        rig = Rig(parameters, options.seed)
    # Compiles what is not compiled yet, for which the first master would have to wait.
    copy.deepcopy(rig).advance(np.array([rig.zero_count], np.uint16))
    device = build(
        rig, parameters, description, virtual_clock=options.clock == "virtual",
        watchdog=options.watchdog, actuator=name,
        sample_period=SAMPLE_PERIOD if options.trial is None else 1.0 / trial.sampling_rate,
    )  # fmt: skip
    tls = _tls_context(options) if description.framing == "tls" else None
    return BenchServer(device, description.host, description.port, tls, options.writer)


def _tls_context(options: argparse.Namespace) -> ssl.SSLContext:
    remedy = "Give --tls-certificate and --tls-key."
    if options.tls_certificate is None:
        raise InputError("framing is tls", file=options.device, field="framing", remedy=remedy)
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    try:
        context.load_cert_chain(options.tls_certificate, options.tls_key)
    except OSError as error:
        raise InputError(
            f"the certificate or its key cannot be read: {error}",
            file=options.tls_certificate,
            remedy=remedy,
        ) from error
    if options.tls_client_ca is not None:
        try:
            context.load_verify_locations(options.tls_client_ca)
        except OSError as error:
            raise InputError(
                f"the authority's certificate cannot be read: {error}",
                file=options.tls_client_ca,
                remedy="Give the certificate that signs the masters' with --tls-client-ca.",
            ) from error
        context.verify_mode = ssl.CERT_REQUIRED
    return context


async def _run(server: BenchServer, until_stdin_closes: bool) -> None:
    task, loop = asyncio.create_task(serve(server, _announce)), asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, task.cancel)
    if until_stdin_closes:
        loop.add_reader(sys.stdin, lambda: os.read(sys.stdin.fileno(), 4096) or task.cancel())
    await task


def _announce(server: BenchServer) -> None:
    address = {
        "host": server.host,
        "port": server.port,
        "unit_id": server.device.description.unit_id,
        "pid": os.getpid(),
    }
    print(json.dumps(address), flush=True)


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


if __name__ == "__main__":
    main()
