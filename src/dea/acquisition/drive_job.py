"""What a recorder asks a guardian to do."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from dea.acquisition.settings import AcquisitionSettings
from dea.modbus import Device


class DriveJob(NamedTuple):
    """What a guardian is to do.

    ``device`` has the address of its host, see :func:`dea.acquisition.transport.known`: a
    look-up of its name may take longer than anybody waits for a sign of life.
    ``counts`` are played from zero to zero; without any, the output is only taken to zero.
    ``replaces`` says that it is so after a guardian that was lost.
    ``token`` claims the outputs of a device that has owners; 0 is that of the guardian before.
    ``latch`` is where a trip is kept. ``started`` is the origin of the link's times, s of the
    monotonic clock. Of a closed loop, ``counts`` are the ramp to its start;
    ``closed_loop_samples`` follow, which the recorder is asked for, no two more than
    ``longest_step`` counts apart.
    """

    device: Device
    settings: AcquisitionSettings
    counts: np.ndarray
    reset: bool
    token: int
    latch: Path
    started: float
    closed_loop_samples: int = 0
    longest_step: int = 0
    replaces: bool = False
