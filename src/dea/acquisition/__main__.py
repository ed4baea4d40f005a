"""Drive and record an actuator from the command line: ``python -m dea.acquisition --help``."""

import argparse
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from dea import store
from dea.acquisition import by_hand, latch
from dea.acquisition.commissioned import write_report
from dea.acquisition.commissioning import commission as staircase
from dea.acquisition.flagged import clock_fault
from dea.acquisition.panel import Panel
from dea.acquisition.partial import samples_kept, where_kept
from dea.acquisition.preview import preview
from dea.acquisition.reported import reported, say
from dea.acquisition.rescue import rescue
from dea.acquisition.retrying_link import BY_HAND, Link
from dea.acquisition.samples import Quality, asked_for
from dea.acquisition.settings import AcquisitionSettings
from dea.acquisition.transport import known
from dea.acquisition.verify import answering_as_described, open_described, verify_device
from dea.acquisition.voltage_plan import plan_sequence
from dea.acquisition.watched import acquire_watched
from dea.configuration.excitation import checked_excitation
from dea.configuration.problems import validated
from dea.configuration.section import Section, Share, key
from dea.errors import DeviceError, InputError
from dea.excitation import KINDS, design
from dea.modbus import BLOCK, REPLY, Device, Register, Value, read_device
from dea.progress import heard_by

WHOLE = 2.0**53  # up to which a float holds every whole number
Command = Callable[[argparse.Namespace], None]


class Commissioned(Section):
    """How far an output is commissioned."""

    share: Share = key("of its limit farther from 0 V")


def main(arguments: list[str] | None = None) -> None:
    """Run one command; exits as :func:`dea.acquisition.reported`."""
    options = _parser().parse_args(arguments)
    with reported():
        options.run(options)


def drive(options: argparse.Namespace) -> None:
    """Drive the device with a designed excitation and write its record."""
    device = _device(options)
    excitation = _excitation_settings(options)
    volts = design(**excitation, sampling_rate=device.sampling_rate, seed=options.seed)
    settings = AcquisitionSettings.from_mapping(
        {"mode": options.mode, "on_break": options.on_break, "ramp_rate": options.ramp_rate,
         "armed_by": options.arm}
    )  # fmt: skip
    if options.dry_run:
        print(preview(device, plan_sequence(device, volts, settings.ramp_rate)))
        return
    link = options.output.with_name(f"{options.output.stem}_link.nc")
    partial = options.output.with_suffix(".partial")
    _refuse_existing(options.output, link)
    acquired = acquire_watched(
        device, volts, partial, settings, live=options.live, reset=options.reset
    )
    # Another program may have made them meanwhile.
    _refuse_existing(options.output, link, remedy=where_kept(partial))
    title = f"Record of {device.name}"
    with samples_kept(partial):
        store.write(acquired.link.assign_attrs(contract="link"), link, title=title)
        made_by = {"acquisition": asdict(settings), "excitation": excitation}
        _write_record(acquired.record, options, title, made_by, options.seed)
    partial.unlink()
    if clock_fault(device, acquired, settings):
        raise DeviceError(f"{options.output} is kept, and no sample of it is good")


def commission(options: argparse.Namespace) -> None:
    """Drive a staircase to a few per cent, and report what the device does."""
    device = known(_device(options))
    settings = AcquisitionSettings.from_mapping(
        {"ramp_rate": options.ramp_rate, "armed_by": options.arm}
    )
    validated(Commissioned, {"share": options.share})
    partial = options.device.with_suffix(".commissioning.partial")
    report = staircase(device, partial, settings, options.share)
    try:  # first: a terminal that has gone must not cost it
        path = write_report(device, report)
    finally:
        print(json.dumps(report, indent=2, sort_keys=True))
    print(f"written to {path}")


def _excitation_settings(options: argparse.Namespace) -> dict[str, Any]:
    """Return the settings of the excitation that is asked for, checked."""
    given = {key: getattr(options, key) for key in ("kind", "duration", "low", "high")}
    if not isinstance(options.setting, dict):
        raise InputError(
            f"it is {options.setting!r}",
            field="setting",
            remedy="Give a mapping: '{\"band\": 1.0}'.",
        )
    for name in given.keys() & options.setting.keys():
        raise InputError(
            "it has an option of its own", field=f"setting.{name}", remedy=f"Give --{name}."
        )
    return checked_excitation(given | options.setting)


def check(options: argparse.Namespace) -> None:
    """Compare the device with its description and print its registers; applies no voltage."""
    device = _device(options)
    link = Link(device, BY_HAND)
    open_described(link)
    try:
        panel = Panel(link)
        with answering_as_described(device):
            verify_device(panel)
        for name, register in device.registers.items():
            if register.access != "write" and name not in (*BLOCK, *REPLY):
                with answering_as_described(device, f"registers.{name}"):
                    value = panel.physical(name)
                unit = "" if register.unit == "1" else f" {register.unit}"
                print(f"{name:24} {_plain(value)}{unit}{_remark(register, value)}")
    finally:
        link.close()
    print(f"{device.name} agrees with its description, {options.device}")


def _plain(value: Value) -> str:
    """Return a value, a whole number without decimals or exponent."""
    if isinstance(value, list):
        return f"[{', '.join(map(_plain, value))}]"
    if not isinstance(value, float):
        return str(value)
    return f"{value:.0f}" if value.is_integer() and abs(value) < WHOLE else f"{value:g}"


def _remark(register: Register, value: Value) -> str:
    """Return what is to be said of a value outside the limits of its register, if it is."""
    if register.limits is None or not isinstance(value, int | float):
        return ""
    low, high = register.limits
    if low - abs(register.scale) <= value <= high + abs(register.scale):
        return ""
    return f"  OUTSIDE its limits, {low:g} to {high:g} {register.unit}: `zero` takes it to zero"


def status(options: argparse.Namespace) -> None:
    """Say who drives the output, what was asked for last and what it reads."""
    print(by_hand.status(_device(options)))


def zero(options: argparse.Namespace) -> None:
    """Take the output to zero, whoever drives it on this machine, and show that it is there."""
    settings = AcquisitionSettings.from_mapping({"ramp_rate": options.ramp_rate})
    with heard_by(say):
        evidence = by_hand.zero(_device(options), settings)
    print(evidence)


def acknowledge(options: argparse.Namespace) -> None:
    """Clear a trip of the safety model, after you have found out why it tripped."""
    reason = latch.acknowledge(known(_device(options)), options.by)
    print("nothing has tripped" if reason is None else f"acknowledged: {reason}")


def dismiss(options: argparse.Namespace) -> None:
    """End a guardian that cannot reach its device, after you have switched the amplifier off."""
    if not options.amplifier_is_off:
        raise InputError(
            "a guardian is dismissed only by somebody who has switched the amplifier off",
            remedy="Switch it off, then repeat with --amplifier-is-off.",
        )
    print(by_hand.dismiss(_device(options)))


def recover(options: argparse.Namespace) -> None:
    """Write what a crashed or broken acquisition had already recorded."""
    _refuse_existing(options.output)
    found = rescue(options.partial, options.device)
    quality = found.record["quality"].values
    print(
        f"{np.count_nonzero(asked_for(quality))} of {found.length} samples, "
        f"{np.count_nonzero(quality != Quality.GOOD)} flagged"
        + (f"; {found.damaged} damaged stretches of the file" if found.damaged else "")
        + "".join(f"; {reason}" for reason in found.reasons)
    )
    title = f"Rescued record of {found.device.name}"
    _write_record(found.record, options, title, {"acquisition": found.settings})


def _refuse_existing(*files: Path, remedy: str = "Give another --output.") -> None:
    for file in files:
        if file.exists():
            raise InputError("exists", file=file, remedy=remedy)


def _write_record(
    record: xr.Dataset,
    options: argparse.Namespace,
    title: str,
    settings: Mapping[str, Any],
    seed: int | None = None,
) -> None:
    store.write(
        record.assign_attrs(contract="record"),
        options.output,
        title=title,
        inputs={"device": record.attrs["device_description"].encode()},
        settings=settings,
        seed=seed,
    )


def _device(options: argparse.Namespace) -> Device:
    if options.device is None:
        raise InputError(
            "it says which output is meant, and is missing",
            field="--device",
            remedy="Give the description of the device: --device config/devices/NAME.yaml",
        )
    return read_device(options.device).at(options.host, options.port)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m dea.acquisition", description=__doc__)
    commands = parser.add_subparsers(required=True)

    def command(name: str, run: Command) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=run.__doc__, description=run.__doc__)
        added.set_defaults(run=run)
        # What is done to the bench does no harm where another device was meant.
        bench = Path("config/devices/virtual_bench.yaml") if run in (drive, check) else None
        by_default = f" (default: {bench})" if bench else ""
        added.add_argument(
            "--device", type=Path, default=bench, help=f"description of the device{by_default}"
        )
        return added

    at_device = {
        "drive": drive, "commission": commission, "check": check, "status": status, "zero": zero,
        "acknowledge": acknowledge, "dismiss": dismiss,
    }  # fmt: skip
    for name, run in at_device.items():
        added = command(name, run)
        added.add_argument("--host", help="instead of the description's")
        added.add_argument("--port", type=int, help="instead of the description's")
        if run is drive:
            _excitation(added)
        if run in (drive, commission):
            added.add_argument(
                "--arm", default="", metavar="NAME",
                help="your name: you have checked the setup and arm the high voltage",
            )  # fmt: skip
        if run is commission:
            added.add_argument(
                "--share", type=float, default=0.03, help="of the limit farther from 0 V"
            )  # fmt: skip
        if run in (drive, commission, zero):
            added.add_argument("--ramp-rate", type=float, default=1.0, metavar="V/S")
        if run is acknowledge:
            added.add_argument("--by", required=True, metavar="NAME")
        if run is dismiss:
            added.add_argument("--amplifier-is-off", action="store_true")
    added = command("recover", recover)
    added.add_argument("partial", type=Path)
    added.add_argument("--output", type=Path, required=True)
    return parser


def _excitation(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--output", type=Path, required=True, help="record to write (NetCDF)")
    parser.add_argument("--kind", choices=sorted(KINDS), default="gaussian")
    parser.add_argument("--duration", type=float, default=60.0, metavar="S")
    parser.add_argument("--low", type=float, default=1.1, metavar="V")
    parser.add_argument("--high", type=float, default=3.75, metavar="V")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--setting", type=json.loads, default={}, metavar="JSON",
        help='further settings of the excitation, as \'{"band": 1.0}\'',
    )  # fmt: skip
    parser.add_argument("--mode", choices=("buffered", "polled"), default="buffered")
    parser.add_argument("--on-break", choices=("stop", "restart"), default="stop")
    parser.add_argument(
        "--dry-run", action="store_true", help="only show voltage, rate, field and charge"
    )
    parser.add_argument("--reset", action="store_true", help="reset a watchdog that has latched")
    parser.add_argument("--live", action="store_true", help="draw voltage and displacement")


if __name__ == "__main__":
    main()
