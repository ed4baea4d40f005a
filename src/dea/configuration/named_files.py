"""The files that config/config.yaml names: device descriptions and published models."""

from collections.abc import Sequence
from pathlib import Path

from dea.configuration.device import DeviceDescription
from dea.configuration.files import read_yaml
from dea.configuration.problems import validated
from dea.configuration.rates import check_rate
from dea.configuration.register import NEEDED
from dea.configuration.safety import refuse_unkept_heartbeat
from dea.configuration.study import FILE, Study
from dea.errors import InputError


def check_actuators(study: Study, served: Sequence[str], bench: str | Path) -> None:
    """Check every device description, and that ``bench`` has every virtual actuator.

    Raises
    ------
    InputError
        Naming the actuator and the names in ``served`` that its ``bench`` may be, or what is wrong
        with a device description.
    """
    devices = {
        f"actuators[{index}].device": actuator.device
        for index, actuator in enumerate(study.actuators)
    } | {"trials.device": study.trials.device}
    for place, device in devices.items():
        _require_file(device, place, "copy a description of config/devices there")
    for device in dict.fromkeys(devices.values()):
        content = read_yaml(
            device, what="the device description", example="one of config/devices/*.yaml"
        )
        described = validated(DeviceDescription, content, device)
        for name in NEEDED:
            if name not in described.registers:
                raise InputError(
                    f"there is no register {name!r}",
                    file=device,
                    field="registers",
                    remedy="Describe it, or correct the name of the register that is meant.",
                )
        refuse_unkept_heartbeat(
            described.safety, study.acquisition.mode, described.sampling_rate, device
        )
        if any(actuator.device == device for actuator in study.actuators):
            check_rate(study, described.sampling_rate, device)
    for index, actuator in enumerate(study.actuators):
        if actuator.bench is not None and actuator.bench not in served:
            raise InputError(
                f"{actuator.name} is to be {actuator.bench!r}, which {bench} does not have",
                file=FILE,
                field=f"actuators[{index}].bench",
                remedy=f"Name one of {', '.join(served)}, or add an entry there.",
            )


def check_files(study: Study) -> None:
    """Check that there is every other file that the study names.

    Raises
    ------
    InputError
        Naming the key.
    """
    _require_file(study.recovery.models, "recovery.models", "name config/published_models.yaml")


def _require_file(named: str, field: str, remedy: str) -> None:
    if not Path(named).is_file():
        raise InputError(
            f"there is no file {named!r}",
            file=FILE,
            field=field,
            remedy=f"Correct the path, or {remedy}.",
        )
