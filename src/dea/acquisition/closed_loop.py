"""A drive whose voltages a controller gives, one sample after the other."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dea.acquisition.sensor_flags import saturated
from dea.acquisition.voltage_plan import OutputPlan, check_excitation, ramp
from dea.errors import DeviceError, InputError
from dea.modbus import Device, limit_counts, representable, to_counts, to_physical

ROUNDING = 1  # count by which a step may exceed the rate


class ControllerError(DeviceError):
    """A controller asked for a voltage that is not allowed, or gave none in time."""


@dataclass(frozen=True)
class ClosedLoop:
    """What a polled acquisition plays instead of a fixed excitation.

    Parameters
    ----------
    controller
        Called once for each sample with the displacement measured in the sample before (in the
        unit of its register, NaN where the sensor's reading is an end of its range); returns the
        voltage of this sample in V. What it raises ends the drive with the ramp to zero.
    samples
        Their number.
    start
        V, to which the output is ramped first; the first call has the displacement measured there.
    rate
        V/s, the largest change of the voltage: a controller that asks for more is stopped.
    """

    controller: Callable[[float], float]
    samples: int
    start: float
    rate: float

    def plan(self, device: Device, ramp_rate: float) -> OutputPlan:
        """Return the counts of the ramp to the start, and how many samples follow it.

        Raises
        ------
        InputError
            Where the start leaves the device's limits, or the rate what its safety model allows.
        """
        allowed = device.safety.max_rate if device.safety else None
        fast = allowed is not None and max(self.rate, ramp_rate) > allowed
        if fast or not (0.0 < self.rate < np.inf and 0.0 < ramp_rate < np.inf):
            raise InputError(
                f"the loop may change the output by {self.rate:g} V/s, the ramp by {ramp_rate:g}",
                file=device.source,
                field="safety.max_rate",
                remedy=f"Give positive rates up to {allowed or np.inf:g} V/s.",
            )
        if self.samples < 1:
            raise InputError("the loop has no samples", remedy="Give at least one.")
        start = check_excitation(device, np.array([self.start]))
        lead = np.concatenate([ramp(device, 0.0, self.start, ramp_rate), start])
        return OutputPlan(lead, lead.size, self.samples)

    def step(self, device: Device) -> int:
        """Return the largest change of the output from sample to sample, in counts."""
        return int(self.rate / device.sampling_rate / abs(device["output"].scale)) + ROUNDING

    def answer(self, device: Device, raw: float) -> int:
        """Return the count of the next sample, given the raw displacement of the last.

        Raises
        ------
        ControllerError
            Where the controller gives no number, or one that no count stands for.
        """
        register = device["displacement"]
        lost = bool(saturated(register, np.array([raw]))[0])
        volts = float(self.controller(np.nan if lost else float(to_physical(register, raw))))
        if not np.isfinite(volts):
            raise ControllerError(f"the controller gave {volts} V")
        low, high = representable(device["output"])
        if not low <= volts <= high:
            raise ControllerError(
                f"the controller asked for {volts:g} V, outside the limits of the output"
            )
        return int(to_counts(device["output"], volts))


class Asked:
    """The counts of a closed loop as the guardian gets them: a ramp, then answers.

    It keeps the limits of the output and of its change, whatever the recorder's side answers.

    Parameters
    ----------
    device, plan, longest_step
        Of :class:`ClosedLoop`.
    ask
        Given the raw displacement of a sample, asks for the count of the next.
    answer
        Waits for what was asked for.
    """

    def __init__(
        self,
        device: Device,
        plan: OutputPlan,
        longest_step: int,
        ask: Callable[[float], None],
        answer: Callable[[], int],
    ) -> None:
        self.device, self.lead, self.longest_step = device, plan.counts.tolist(), longest_step
        self.size = plan.lead + plan.length
        self._low, self._high = limit_counts(device)
        self._ask, self._answer, self._asking = ask, answer, False
        self._last: int = self.lead[-1]

    def count(self, number: int) -> int:
        """Return the count of a sample.

        Raises
        ------
        ControllerError
            Where it is outside the limits, or farther from the last than the rate allows.
        """
        if number < len(self.lead):
            return int(self.lead[number])
        if self._asking:
            count, self._asking = self._answer(), False
            inside = self._low <= count <= self._high
            if not inside or abs(count - self._last) > self.longest_step:
                volts, last = (
                    float(to_physical(self.device["output"], n)) for n in (count, self._last)
                )
                what = "faster than its rate" if inside else "outside the limits of the output"
                raise ControllerError(
                    f"the controller asked for {volts:g} V after {last:g} V, {what}"
                )
            self._last = count
        return self._last

    def measured(self, number: int, displacement: float) -> None:
        """Note the raw displacement of a sample; after the ramp, ask for the next count."""
        if len(self.lead) - 1 <= number < self.size - 1:
            self._ask(displacement)
            self._asking = True
