"""What the flags of a record say, for the person who has just made it."""

from typing import TYPE_CHECKING

import numpy as np

from dea.acquisition.acquire import AcquiredRecord
from dea.acquisition.samples import Quality
from dea.acquisition.settings import AcquisitionSettings
from dea.modbus import Device

if TYPE_CHECKING:
    import xarray as xr


def flags_said(record: "xr.Dataset") -> str:
    """Return in a line how many samples are good, and how many carry which flag."""
    from dea import store

    quality = record["quality"].values
    counts = {"good": int(np.count_nonzero(quality == Quality.GOOD))} | store.flag_counts(record)
    listed = ", ".join(f"{count} {name}" for name, count in counts.items())
    return f"{quality.size} samples: {listed}"


def clock_fault(
    device: Device, acquired: AcquiredRecord, settings: AcquisitionSettings
) -> str | None:
    """Return in a line why a record is flagged for its clock, and the remedy; None if it is not."""
    if not (acquired.record["quality"].values & Quality.CLOCK).any():
        return None
    described, rate = device.sampling_rate, float(acquired.link["fitted_rate"])
    return (
        f"the device samples at {rate:.5g} Hz by this computer's clock, and at {described:g} Hz by"
        f" its description: {abs(rate / described - 1):.2%} apart, and acquisition.clock_tolerance"
        f" is {settings.clock_tolerance:.2%}. Every sample is flagged, and the study takes none."
        f" Set the clock of the device, or sampling_rate in {device.source}, and record it again"
    )
