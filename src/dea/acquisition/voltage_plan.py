"""The counts that are played for an excitation in volts, checked before the first is written."""

from typing import NamedTuple

import numpy as np

from dea.errors import InputError
from dea.modbus import Device, limit_counts, representable, to_counts, to_physical


class Planned:
    """The counts of a polled drive that are all known beforehand, from that of ``zero`` on."""

    def __init__(self, counts: np.ndarray, zero: int) -> None:
        self._counts, self.size = counts.tolist(), counts.size
        self.longest_step = int(np.abs(np.diff(counts, prepend=zero)).max())

    def count(self, number: int) -> int:
        """Return the count of a sample."""
        return int(self._counts[number])

    def measured(self, number: int, displacement: float) -> None:
        """Take no notice of what was measured."""


class OutputPlan(NamedTuple):
    """Output counts from zero to zero: ``lead`` samples of ramp, ``length`` of excitation, ramp.

    Those of a closed loop are the ramp alone: the others are asked for.
    """

    counts: np.ndarray
    lead: int
    length: int


def plan_sequence(device: Device, excitation: np.ndarray, ramp_rate: float) -> OutputPlan:
    """Put ramps at ``ramp_rate`` V/s before and after an excitation in V.

    Raises
    ------
    InputError
        Where the excitation leaves the device's limits, is empty, or changes too fast.
    """
    if not 0 < ramp_rate < np.inf:
        raise InputError(f"ramp_rate {ramp_rate:g} V/s", remedy="Give a positive, finite rate.")
    volts = np.asarray(excitation, float)
    if volts.ndim != 1 or not volts.size:
        raise InputError("the excitation holds no samples", remedy="Give at least one voltage.")
    counts = check_excitation(device, volts)
    lead = ramp(device, 0.0, float(volts[0]), ramp_rate)
    tail = ramp(device, float(volts[-1]), 0.0, ramp_rate)
    zero = to_counts(device["output"], np.zeros(1))
    plan = OutputPlan(np.concatenate([lead, counts, tail, zero]), lead.size, counts.size)
    _refuse_too_fast(device, plan, ramp_rate)
    return plan


def _refuse_too_fast(device: Device, plan: OutputPlan, ramp_rate: float) -> None:
    """Refuse ramps and steps beyond the largest rate.

    A ramp is refused whether or not the sequence holds one: the output is also taken to zero at its
    rate from wherever a drive ends.
    """
    allowed = device.safety.max_rate if device.safety else None
    if allowed is None:
        return
    if ramp_rate > allowed:
        raise InputError(
            f"the output is to be ramped by {ramp_rate:g} V/s, and {allowed:g} V/s are allowed",
            file=device.source,
            field="safety.max_rate",
            remedy="Give a slower ramp_rate.",
        )
    played = np.append(0.0, to_physical(device["output"], plan.counts))
    rates = np.abs(np.diff(played)) * device.sampling_rate
    one_count = abs(device["output"].scale) * device.sampling_rate
    if rates.max() > allowed + one_count:
        raise InputError(
            f"the output is to change by {rates.max():g} V/s at sample {rates.argmax()}, "
            f"and {allowed:g} V/s are allowed",
            file=device.source,
            field="safety.max_rate",
            remedy="Give a narrower band or smaller steps.",
        )


def check_excitation(device: Device, volts: np.ndarray) -> np.ndarray:
    """Output counts of an excitation in V, checked against the device's limits.

    Raises
    ------
    InputError
        Naming the sample farthest outside the limits.
    """
    edges = limit_counts(device)
    register = device["output"]
    if not np.all(np.isfinite(volts)):
        raise InputError("the excitation holds NaN or infinity", remedy="Give finite voltages.")
    # A voltage that no count represents is outside the limits too, with the same message.
    low, high = representable(register)
    held = np.clip(volts, low, high)
    counts = to_counts(register, held)
    outside = (counts < edges[0]) | (counts > edges[1])
    outside |= np.abs(volts - held) > abs(register.scale) / 2
    if outside.any():
        ends = np.clip(register.limits or (low, high), low, high)
        worst = int(np.argmax(np.maximum(volts - ends[1], ends[0] - volts)))
        raise InputError(
            f"sample {worst} of the excitation asks for {volts[worst]:g} V, outside "
            f"{ends[0]:g} to {ends[1]:g} V",
            file=device.source,
            field="registers.output.limits",
            remedy="Lower the excitation, or raise the limits if film and amplifier bear it.",
        )
    return counts


def ramp(device: Device, start: float, end: float, rate: float) -> np.ndarray:
    """Counts from ``start`` V towards ``end`` V at ``rate`` V/s, both ends left out."""
    steps = int(np.ceil(abs(end - start) / rate * device.sampling_rate))
    return to_counts(device["output"], np.linspace(start, end, steps + 1)[1:-1])
