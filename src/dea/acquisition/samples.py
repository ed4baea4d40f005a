"""Samples as read from the device, and their quality flags."""

from enum import IntFlag
from typing import NamedTuple

import numpy as np

from dea.errors import DeviceError


class Quality(IntFlag):
    """Flags of a sample; 0 is good."""

    GOOD = 0
    HELD = 1  # nothing was there to play and the device held its last output
    LOST = 2  # measured but overwritten before it was read, or never read
    LATE = 4  # driven later than its deadline allows
    UNDRIVEN = 8  # the device had taken its output to zero
    CLAMPED = 16  # the device applied another voltage than was asked for
    STUCK = 32  # the sensor's reading stood still while the output moved
    SATURATED = 64  # the sensor's reading is an end of its range
    CLOCK = 128  # the device's clock and the host's do not agree


def asked_for(quality: np.ndarray) -> np.ndarray:
    """Return which samples are those of the excitation, by their flags, (samples,) bool.

    The others are what the device measured while it held the output of one of these.
    """
    return np.asarray((quality & Quality.HELD) == 0)


class DrivenSamples(NamedTuple):
    """Consecutive samples; ``position`` is their place in the sequence to be played.

    ``applied`` and ``displacement`` are raw, integers or floats as the device has them.
    ``write_time`` and ``read_time`` are those of the host, s since the link's start, of sending the
    sample and of having read it; the first is NaN where the device plays by itself.
    """

    position: np.ndarray
    device_index: np.ndarray
    requested: np.ndarray
    applied: np.ndarray
    displacement: np.ndarray
    quality: np.ndarray
    write_time: np.ndarray
    read_time: np.ndarray

    @classmethod
    def lost(cls, position: int, index: int, requested: np.ndarray) -> "DrivenSamples":
        """Placeholders for samples that were not read."""
        n, nothing = requested.size, np.zeros(requested.size, np.int64)
        steps = np.arange(n)
        flags = np.full(n, Quality.LOST)
        never = np.full(n, np.nan)
        return cls(
            position + steps, index + steps, requested, nothing, nothing, flags, never, never
        )


class BrokenRecordError(DeviceError):
    """Samples are missing or were not driven as requested; the message says which and why.

    ``samples`` are these samples, flagged, as far as their positions are known.
    """

    def __init__(self, reason: str, first: int, count: int, samples: DrivenSamples) -> None:
        self.reason, self.first, self.count, self.samples = reason, first, count, samples
        super().__init__(f"samples {first} to {first + count - 1}: {reason}")
