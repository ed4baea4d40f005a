"""One actuator and its instruments, from output counts to displacement counts."""

from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.plant.amplifier import amplify
from dea.plant.film import FAULT, SUBSTEP, Y, rest
from dea.plant.film import advance as advance_film
from dea.plant.membrane import capacitance
from dea.plant.parameters import Parameters, read_parameters
from dea.plant.sensor import AntiAliasFilter
from dea.seeds import generator

SAMPLE_PERIOD = 0.02  # s
SUBSTEPS = round(SAMPLE_PERIOD / SUBSTEP)


class Rig:
    """Output converter, amplifier, film, laser and displacement converter in series.

    The rig has no clock of its own: each output count advances time by one sample period (20 ms),
    and the measurement depends on the counts alone, not on how they are cut into calls.

    Parameters
    ----------
    parameters
        Of the actuator and its instruments.
    seed
        Of the measurement noise.
    """

    def __init__(self, parameters: Parameters, seed: int) -> None:
        self._parameters = parameters
        self._noise = generator(seed, "bench", "noise")
        self._state = rest(parameters.film, parameters.rest)
        start = float(self._state.scalars[Y])
        if not np.isfinite(start):
            raise InputError(
                "the film does not carry the mass",
                field="film",
                remedy="Lower the mass or stiffen the film.",
            )
        self._output = np.zeros(1)
        self._load = capacitance(parameters.film, 1.0)
        cutoff = parameters.sensor.cutoff
        self._filter = AntiAliasFilter(cutoff, start) if cutoff < np.inf else None
        self.applied_count = self.zero_count

    @classmethod
    def from_config(cls, path: Path, actuator: str, seed: int) -> Self:
        """Return the rig of ``actuator`` in the bench configuration at ``path``.

        Raises
        ------
        InputError
            As :func:`dea.plant.parameters.read_parameters`.
        """
        return cls(read_parameters(path, actuator), seed)

    @property
    def zero_count(self) -> int:
        """The output count nearest to 0 V."""
        return int(self._parameters.output_converter.to_counts(np.zeros(1))[0])

    @property
    def fault(self) -> int:
        """0 without a fault, 1 after pull-in, 2 after electrical breakdown; latched."""
        return int(self._state.scalars[FAULT])

    def advance(
        self, output_counts: NDArray[np.uint16]
    ) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
        """Apply one output count per sample period and measure once in each.

        Displacement k is sampled at the instant at which output k takes effect: it depends on the
        outputs before k.

        Parameters
        ----------
        output_counts
            Counts of the output converter, shape (samples,).

        Returns
        -------
        tuple
            The applied counts as the converter echoes them and the counts of the measured
            displacement, each of shape (samples,).
        """
        applied = np.asarray(output_counts, dtype=np.uint16)
        reading = self.respond(applied)
        sensor = self._parameters.sensor
        noisy = reading + sensor.noise * self._noise.standard_normal(reading.size)
        measured = self._parameters.displacement_converter.to_counts(1e3 * noisy)
        if applied.size:
            self.applied_count = int(applied[-1])
        return applied, measured

    def respond(self, output_counts: NDArray[np.uint16]) -> Array:
        """Return the readings in m without noise, shape (samples,)."""
        return self.drive(output_counts)[2]

    def drive(self, output_counts: NDArray[np.uint16]) -> tuple[Array, Array, Array]:
        """Return what happens in the rig, which :meth:`advance` does not measure.

        Displacement in m and film voltage in V at every sub-step, and the reading in m without
        noise of every sample.
        """
        parameters, applied = self._parameters, np.asarray(output_counts, dtype=np.uint16)
        command = np.repeat(parameters.output_converter.to_values(applied), SUBSTEPS)
        supply = np.empty_like(command)
        amplify(parameters.amplifier, self._output, self._load, command, supply)
        displacement = np.empty_like(supply)
        film_voltage = np.empty_like(supply)
        advance_film(
            parameters.film,
            self._state,
            None,
            supply,
            displacement,
            film_voltage,
        )
        sensor = parameters.sensor
        reading = np.clip(displacement, sensor.range_low, sensor.range_high)
        if self._filter is not None:
            reading = self._filter.advance(reading)
        return displacement, film_voltage, reading[::SUBSTEPS]
