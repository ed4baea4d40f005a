"""Record an actuator of the study into ``records/``: ``python -m dea.stages.record --help``."""

import argparse
import getpass
import os
import platform
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from dea import acquisition, archive, modbus, store
from dea.configuration.acquisition import Actuator
from dea.configuration.bench import BENCH, read_bench
from dea.configuration.excitation import sections
from dea.configuration.files import read_text_and_yaml
from dea.configuration.named_files import check_actuators
from dea.configuration.problems import did_you_mean
from dea.configuration.study import FILE, check_study
from dea.configuration.study import settings as written
from dea.errors import DeviceError, InputError
from dea.stages.driving import PlayedExcitation, excitation, write

EXCITATIONS = ("record", "second", "probed")


def record(name: str, excitation_name: str, operator: str) -> Path:
    """Drive the actuator ``name`` of the study with one of its excitations and keep its record.

    ``operator`` arms the device; where it is empty, ``acquisition.armed_by`` of the study does.

    Returns
    -------
    Path
        The folder of the record.

    Raises
    ------
    InputError, DeviceError
        As :func:`dea.acquisition.acquire`. What was recorded until then stays in a folder whose
        name ends in ``.partial``.
    """
    config, content = read_text_and_yaml(FILE, what="the configuration", example=FILE)
    study = check_study(content)
    check_actuators(study, list(read_bench(BENCH).actuators), BENCH)
    actuator = _actuator(study.actuators, name)
    device = modbus.read_device(Path(actuator.device))
    acquisition.refuse_unarmed(device, operator or study.acquisition.armed_by)
    settings: dict[str, Any] = {
        "seed": study.seed,
        "system": name,
        "excitation_name": excitation_name,
        "acquisition": written(study.acquisition),
    } | sections(written(study.excitation), excitation_name)
    return keep(device, excitation(settings, device), settings, operator, config)


def keep(
    device: modbus.Device,
    played: PlayedExcitation,
    settings: Mapping[str, Any],
    operator: str,
    config: str,
) -> Path:
    """Drive a device and keep its record in ``records/``; return the folder of the record.

    ``settings`` name the ``system`` and the ``excitation_name``, and hold ``acquisition``;
    ``config`` is the text that they were read from, which is kept with the record.

    Raises
    ------
    InputError, DeviceError
        As :func:`record`; DeviceError also where the record is kept, but the device's clock is
        beyond the tolerance.
    """
    device_file = Path(str(device.source))
    name, excitation_name = settings["system"], settings["excitation_name"]
    options = acquisition.AcquisitionSettings.from_mapping(
        settings["acquisition"] | ({"armed_by": operator} if operator else {})
    )
    # As they were read: the files may have been edited since.
    beside = {"device.yaml": device.described, "config.yaml": config}
    commissioned = acquisition.report_file(device_file)
    if commissioned.exists():
        beside["commissioned.json"] = commissioned.read_text()
    # Before the drive, too: whatever cannot be found out is to cost no record.
    facts = {
        "operator": options.armed_by or _account(),
        "computer": platform.node(),
        "software": _software(),
    }
    begun = datetime.now(UTC)
    with archive.unfinished(name, now=begun) as folder:
        partial = folder / archive.SAMPLES
        acquired = acquisition.acquire_watched(device, played.volts, partial, options)
        files = {"record": folder / "record.nc", "link": folder / "link.nc"}
        with acquisition.samples_kept(partial):
            write(played.label(acquired), files, settings)
            for file, text in beside.items():
                (folder / file).write_bytes(text.encode())
        fault = acquisition.clock_fault(device, acquired, options)
        content = {
            "name": name,
            "excitation": excitation_name,
            "begun": begun.isoformat(timespec="seconds"),
            "ended": datetime.now(UTC).isoformat(timespec="seconds"),
            **facts,
            "settings": settings,
            "samples": acquired.record.sizes["time"],
            "flagged": store.flag_counts(acquired.record),
        }
        with acquisition.samples_kept(partial):
            kept = archive.seal(folder, content | ({archive.FAULT: fault} if fault else {}))
    if fault:
        raise DeviceError(f"{kept} is kept, and no sample of it is good: see the line on its clock")
    return kept


def _actuator(actuators: list[Actuator], name: str) -> Actuator:
    known = {actuator.name: actuator for actuator in actuators}
    if name not in known:
        raise InputError(
            f"there is no actuator {name!r}",
            file=FILE,
            field="actuators",
            remedy=f"{did_you_mean(name, known)}There are {', '.join(known)}.",
        )
    if known[name].bench is not None:
        raise InputError(
            f"{name} is virtual, and the study acquires it by itself",
            file=FILE,
            field=f"actuators[{list(known).index(name)}].bench",
            remedy="Take `bench` away to drive the device of its description.",
        )
    return known[name]


def _account() -> str:
    """Return the name of this account, or its number where it has none, as in a container."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return f"user {os.getuid()}"


def _software() -> dict[str, str]:
    """Return the version of this project, and its commit where it is in a repository."""
    found = {"dea-study": version("dea-study"), "python": platform.python_version()}
    try:
        said = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=40"],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
    except (OSError, subprocess.CalledProcessError):
        return found
    return found | {"commit": said.stdout.strip()}


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; exits as :func:`dea.acquisition.reported`."""
    parser = argparse.ArgumentParser(prog="python -m dea.stages.record", description=__doc__)
    parser.add_argument("name", help="an actuator of config/config.yaml without `bench`")
    parser.add_argument("--excitation", metavar=f"{{{','.join(EXCITATIONS)}}}", default="record")
    parser.add_argument(
        "--operator", default="", help="your name: you have checked the setup and arm the device"
    )
    options = parser.parse_args(arguments)
    with acquisition.reported():
        if options.excitation not in EXCITATIONS:
            raise InputError(
                f"there is no excitation {options.excitation!r}",
                field="EXCITATION",
                remedy=f"{did_you_mean(options.excitation, EXCITATIONS)}"
                f"Use one of {', '.join(EXCITATIONS)}.",
            )
        print(record(options.name, options.excitation, options.operator))


if __name__ == "__main__":
    main()
