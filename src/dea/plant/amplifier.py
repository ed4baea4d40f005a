"""The high-voltage amplifier: gain, saturation, and limits of slew rate and current."""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.film import SUBSTEP


class Amplifier(NamedTuple):
    """The parameters of the amplifier (SI units)."""

    gain: float
    output_limit: float
    slew_rate: float
    current_limit: float
    cable_capacitance: float
    bandwidth: float


@njit(cache=True)
def amplify(
    amplifier: Amplifier, output: Array, load: float, command: Array, supply: Array
) -> None:
    """Fill ``supply`` (V) from ``command`` (V before the amplifier), one element per sub-step.

    ``output`` is the output voltage carried from call to call, shape (1,); ``load`` is the
    capacitance in F that the current limit charges besides the cable. The output follows its
    target with a first-order lag, within the slew rate and the current limit.
    """
    capacity = load + amplifier.cable_capacitance
    fastest = min(amplifier.slew_rate, amplifier.current_limit / capacity) * SUBSTEP
    share = 1.0 - np.exp(-2.0 * np.pi * amplifier.bandwidth * SUBSTEP)
    voltage = output[0]
    for k in range(command.shape[0]):
        target = min(max(amplifier.gain * command[k], 0.0), amplifier.output_limit)
        step = share * (target - voltage)
        voltage += min(max(step, -fastest), fastest)
        supply[k] = voltage
    output[0] = voltage
