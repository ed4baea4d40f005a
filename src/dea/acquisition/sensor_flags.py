"""Flags of a sensor whose readings cannot be right, set on the samples it happened to."""

import numpy as np

from dea.acquisition.samples import DrivenSamples, Quality
from dea.modbus import Device, Register, to_physical

STUCK_SAMPLES = 25  # equal readings in a row that are no chance
STUCK_SHARE = 0.1  # of the span of the output's limits, that the output moves meanwhile
_READ = ~(Quality.LATE | Quality.CLAMPED)  # the flags of samples that were read for all that


def flag_sensor(device: Device, samples: DrivenSamples) -> DrivenSamples:
    """Return ``samples`` with :attr:`Quality.SATURATED` and :attr:`Quality.STUCK` where they hold.

    A reading is saturated at an end of what an integer register can hold. It is stuck where it
    has been the same for many samples while the output moved.
    """
    read = (samples.quality & int(_READ)) == 0
    flags = np.where(
        read & saturated(device["displacement"], samples.displacement), Quality.SATURATED, 0
    )
    flags = flags | np.where(read & _stuck(device, samples), Quality.STUCK, 0)
    return samples._replace(quality=samples.quality | flags)


def saturated(register: Register, raw: np.ndarray) -> np.ndarray:
    """Whether raw readings are an end of what the register can hold."""
    if "float" in register.type:
        return np.asarray(~np.isfinite(raw))
    ends = np.iinfo(register.type)
    # An unsigned count with a scale alone is 0 where nothing is displaced.
    bottom = register.range is not None or ends.min < 0
    return np.asarray((raw == ends.max) | ((raw == ends.min) & bottom))


def _stuck(device: Device, samples: DrivenSamples) -> np.ndarray:
    """Whether each sample is in a run of equal readings during which the output moved."""
    stuck = np.zeros(samples.position.size, bool)
    volts = to_physical(device["output"], samples.requested)
    low, high = device["output"].limits or (volts.min(initial=0.0), volts.max(initial=0.0))
    starts = np.flatnonzero(np.diff(samples.displacement, prepend=np.nan) != 0)
    ends = np.append(starts[1:], stuck.size)
    long = ends - starts >= STUCK_SAMPLES  # few are, and the others are not looked at
    for start, end in zip(starts[long], ends[long], strict=True):
        if np.ptp(volts[start:end]) >= STUCK_SHARE * (high - low):
            stuck[start:end] = True
    return stuck
