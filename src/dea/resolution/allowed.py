"""What a study, a device and its records allow of a designed excitation."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dea import store
from dea.configuration.study import Study
from dea.resolution.excitation import Limits

if TYPE_CHECKING:
    import xarray as xr

    from dea.modbus import Device


def allowed_by_device(study: Study, device: "Device", record: "xr.Dataset") -> Limits:
    """Return what the excitations of the study, the device and its first record allow.

    Of the rates that are given, by the study and the device, the smallest holds.
    """
    own = allowed_by_records(study, [record])
    played = study.excitation.record
    of_device = device.safety.max_rate if device.safety else None
    given = [each for each in (study.resolution.rate, of_device) if each]
    rate = min(given, default=own.rate)
    return Limits(
        played.low, played.high, rate, own.output_low, own.output_high, device.sampling_rate
    )


def allowed_by_records(study: Study, records: "Sequence[xr.Dataset]") -> Limits:
    """Return what the records of a device allow, at the rate of the study if it gives one."""
    signals = [store.signals(record) for record in records]
    return Limits.of(signals, study.resolution.output_margin, study.resolution.rate)
