"""What an excitation would do, before anything is armed."""

import numpy as np

from dea.acquisition.voltage_plan import OutputPlan
from dea.modbus import Device, to_physical


def preview(device: Device, plan: OutputPlan) -> str:
    """Return lines on the voltage, its rate and, where the description allows, charge and field."""
    volts = np.append(0.0, to_physical(device["output"], plan.counts))
    rate = np.abs(np.diff(volts)).max() * device.sampling_rate
    seconds = plan.counts.size / device.sampling_rate
    lines = [
        f"duration        {seconds:g} s, {plan.counts.size} samples with ramps",
        f"output          {volts.min():g} to {volts.max():g} V, limits {device['output'].limits}",
        f"largest rate    {rate:g} V/s",
    ]
    safety = device.safety
    if safety is None or safety.amplifier_gain is None:
        lines.append("high voltage    unknown: safety.amplifier_gain is not described")
        return "\n".join(lines)
    high, high_rate = safety.amplifier_gain * np.abs(volts).max(), safety.amplifier_gain * rate
    lines.append(f"high voltage    {high:g} V, changing by up to {high_rate:g} V/s")
    if (film := safety.film) is not None:
        per_volt = 1e-3 * film.capacitance  # uC per V, and uA per V/s
        lines += [
            f"field           {high / film.thickness:g} V/um",
            f"charge          {high * per_volt:g} uC",
            f"current         {high_rate * per_volt:g} uA at most, charging",
        ]
    return "\n".join(lines)
