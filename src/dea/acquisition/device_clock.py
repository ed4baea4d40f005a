"""The clock of a device that plays by itself, against the host's."""

import numpy as np

from dea.acquisition.samples import DrivenSamples, Quality
from dea.modbus import Device

SHORTEST = 20.0  # s of reading below which its rate is not known well enough


def fitted_rate(samples: DrivenSamples) -> float | None:
    """Return the device's sampling rate, Hz of the host's clock, by least squares over the blocks.

    None where there are too few samples that the device played by itself.
    """
    played = np.isnan(samples.write_time) & ~np.isnan(samples.read_time)
    index, read = samples.device_index[played], samples.read_time[played]
    last = np.flatnonzero(np.diff(read, append=np.inf) > 0)  # the newest sample of each block
    if last.size < 3 or read[-1] - read[0] < SHORTEST:
        return None
    slope = np.polyfit(read[last] - read[0], index[last] - index[0], 1)[0]
    return float(slope)


def flag_clock(device: Device, samples: DrivenSamples, tolerance: float) -> DrivenSamples:
    """Return ``samples``, all with :attr:`Quality.CLOCK` where the rates differ beyond a share.

    A virtual device plays as fast as samples arrive; its clock is not compared.
    """
    rate = fitted_rate(samples)
    if device.virtual or rate is None or abs(rate / device.sampling_rate - 1) <= tolerance:
        return samples
    return samples._replace(quality=samples.quality | Quality.CLOCK)
