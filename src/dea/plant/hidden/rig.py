"""One trial's device with its hidden effects and its readings, sample by sample."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.plant.converter import Converter
from dea.plant.film import SUBSTEP
from dea.plant.forces import ForceLaw
from dea.plant.hidden.devices import Plain
from dea.plant.hidden.effect import Law
from dea.plant.hidden.noise import Noise, NoiseSource
from dea.plant.signal_law import SignalLaw


class TrialRig:
    """Input path, device and output path in series, read at a sampling rate.

    It has no clock of its own: each command advances time by one sample period, and the readings
    depend on the commands alone, not on how they are cut into calls.

    Parameters
    ----------
    plain
        The device.
    laws
        Its hidden effects, in the order of the signal path.
    sampling_rate
        In Hz; the sample period is a whole number of sub-steps.
    shift
        Sub-steps by which readings are taken later than the command they are stamped with.
    """

    def __init__(
        self, plain: Plain, laws: Sequence[Law], sampling_rate: float, shift: int = 0
    ) -> None:
        self.substeps = round(1.0 / (sampling_rate * SUBSTEP))
        self._machine = plain.machine([law for law in laws if isinstance(law, ForceLaw)])
        signal_laws = [law for law in laws if isinstance(law, SignalLaw)]
        self._input_laws = [law for law in signal_laws if not law.output]
        self._output_laws = [law for law in signal_laws if law.output]
        self._shift = shift
        self._tail: Array | None = None

    @property
    def broken(self) -> bool:
        """Whether the device has failed."""
        return self._machine.broken

    def respond(self, commands: Array) -> Array:
        """Return a reading without noise for each command (V), shape (samples,)."""
        if not commands.size:
            return np.zeros(0)
        command = np.repeat(np.asarray(commands, dtype=np.float64), self.substeps)
        for law in self._input_laws:
            law.advance(command)
        output = self._machine.advance(command)
        for law in self._output_laws:
            law.advance(output)
        if self._shift >= 0:
            return output[self._shift :: self.substeps].copy()
        # An early reading needs outputs of the piece before: keep the last ones.
        before = np.full(-self._shift, output[0]) if self._tail is None else self._tail
        joined = np.concatenate([before, output])
        self._tail = joined[joined.size + self._shift :].copy()
        return joined[: output.size : self.substeps].copy()


class ServedRig:
    """A trial's rig behind converters, as the bench plays it.

    Parameters
    ----------
    rig, noise, seed
        The device, the noise of its readings (in its own unit) and its seed.
    output, reading
        The converters of commands (V) and of readings (in the unit of records).
    scale
        The unit of records over the device's own.

    Attributes
    ----------
    truth
        Every reading since the start without noise, in the unit of records.
    """

    def __init__(
        self, rig: TrialRig, noise: Noise, seed: int, output: Converter, reading: Converter,
        scale: float,
    ) -> None:  # fmt: skip
        self._rig, self._source = rig, NoiseSource(noise, seed)
        self._output, self._reading, self._scale = output, reading, scale
        self._pieces: list[Array] = []

    @property
    def truth(self) -> Array:
        """Every reading so far without noise."""
        return np.concatenate(self._pieces) if self._pieces else np.zeros(0)

    @property
    def zero_count(self) -> int:
        """The output count nearest to 0 V."""
        return int(self._output.to_counts(np.zeros(1))[0])

    def advance(
        self, output_counts: NDArray[np.uint16]
    ) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
        """Apply one count per sample period; return applied and measured counts, (samples,)."""
        applied = np.asarray(output_counts, dtype=np.uint16)
        truth = self._rig.respond(self._output.to_values(applied))
        self._pieces.append(self._scale * truth)
        measured = self._reading.to_counts(self._scale * self._source.read(truth))
        return applied, measured
