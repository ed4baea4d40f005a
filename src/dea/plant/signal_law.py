"""The law of an effect on the input or output path."""

from collections.abc import Callable

import numpy as np

from dea.arrays import Array
from dea.plant.array import Values


class SignalLaw:
    """A law on a signal at the sub-step rate: a kernel with its constants and its memory.

    The kernel changes the signal in place and carries the memory from call to call, so that the
    result does not depend on how the signal is cut into calls.

    Parameters
    ----------
    kernel
        Called with the constants, the memory and the signal.
    constants, memory
        Of the law; the memory as it is at the start.
    output
        Whether the signal is the measured displacement (m) or the command before the amplifier (V).
    """

    def __init__(
        self,
        kernel: Callable[[Array, Array, Array], None],
        constants: Values,
        memory: Values = (0.0,),
        *,
        output: bool = False,
    ) -> None:
        self.output = output
        self._kernel = kernel
        self._constants = np.array(constants, dtype=np.float64)
        self._memory = np.array(memory, dtype=np.float64)

    def advance(self, signal: Array) -> None:
        """Apply the law to the next piece of the signal, in place."""
        self._kernel(self._constants, self._memory, signal)
