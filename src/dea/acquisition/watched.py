"""An acquisition as a person runs it, with progress on the terminal."""

import sys
from contextlib import suppress
from pathlib import Path

import numpy as np

from dea.acquisition.acquire import AcquiredRecord, acquire
from dea.acquisition.flagged import clock_fault, flags_said
from dea.acquisition.settings import AcquisitionSettings
from dea.acquisition.voltage_plan import plan_sequence
from dea.modbus import Device


def acquire_watched(
    device: Device,
    excitation: np.ndarray,
    partial: Path,
    settings: AcquisitionSettings,
    *,
    live: bool = False,
    reset: bool = False,
) -> AcquiredRecord:
    """Acquire as :func:`dea.acquisition.acquire`, show how far it is, and say what was flagged.

    Parameters
    ----------
    live
        Whether voltage and displacement are drawn too.

    Raises
    ------
    InputError, DeviceError
        As :func:`dea.acquisition.acquire`.
    """
    plan = plan_sequence(device, excitation, settings.ramp_rate)
    # The display takes a while to import, and a job of the workflow has none.
    from dea.acquisition.display import Display

    with Display(device, plan.counts.size, live=live) as display:
        acquired = acquire(device, excitation, partial, settings, watch=display, reset=reset)
    lines = [flags_said(acquired.record), clock_fault(device, acquired, settings)]
    with suppress(OSError):  # nobody there to read it, and the record is not written yet
        print(*filter(None, lines), sep="\n", file=sys.stderr)
    return acquired
