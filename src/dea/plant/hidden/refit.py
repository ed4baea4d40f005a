"""The strength of a hidden effect: what a refitted plain actuator does not explain of it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dea.least_squares import Damping, Model, Point, minimise
from dea.plant.array import Array
from dea.plant.film import vertical_stiffness
from dea.plant.hidden.effect import Conditions
from dea.plant.parameters import Parameters
from dea.plant.rig import SAMPLE_PERIOD, Law, Rig

_FREE = ("permittivity", "yeoh_1", "damping")
_STEP = 1e-3  # relative, of the finite differences
_LONGEST = 0.7  # largest change of a parameter's logarithm in one Gauss-Newton step
_UNCHANGED = np.zeros(len(_FREE))
_ROUNDS = 8
_DAMPING = Damping(first=1e-4, least=0.0, tries=_ROUNDS)  # of the squared sensitivities
_ENOUGH = 0.02  # relative decrease of the residual below which the refit has converged
_SETTLING = 100  # samples at the first value before the record begins


class Yardstick:
    """Measures the strength of effects on one actuator under one excitation.

    Parameters
    ----------
    parameters
        The plain actuator.
    output_counts
        The excitation, shape (samples,).

    Attributes
    ----------
    plain
        Reading of the plain actuator in m, shape (samples,).
    basis
        What small changes of the free parameters, scale and offset add to it, by column.
    """

    def __init__(self, parameters: Parameters, output_counts: NDArray[np.uint16]) -> None:
        self._parameters = parameters
        self._counts = np.concatenate([np.repeat(output_counts[:1], _SETTLING), output_counts])
        self.plain = self.respond(_UNCHANGED)
        self.basis = self.linearised(_UNCHANGED, self.plain)

    def conditions(self) -> Conditions:
        """Return what the excitation does to the plain actuator."""
        rest = float(Rig(self._parameters, seed=0).respond(np.zeros(1, np.uint16))[0])
        command = self._parameters.output_converter.to_values(self._counts)
        return Conditions(
            low=float(command.min()),
            high=float(command.max()),
            rest=rest,
            bottom=float(self.plain.min()),
            median=float(np.median(self.plain)),
            top=float(self.plain.max()),
            stiffness=vertical_stiffness(self._parameters.film),
            duration=self._counts.size * SAMPLE_PERIOD,
        )

    def strength(self, laws: list[Law]) -> float:
        """Return the RMS residual of the refitted plain actuator over the RMS noise.

        Gain, stiffness and dashpot of the film, and scale and offset of the reading are free.
        Infinite where the effect breaks the film or leaves the range of the sensor.
        """
        reading = self._disturbed(laws)
        if reading is None:
            return np.inf
        return self.unexplained(reading) / self._parameters.sensor.noise

    def unexplained(self, reading: Array) -> float:
        """Return the RMS residual, m, of the plain actuator refitted to a reading."""
        refit = minimise(
            _Refit(self, reading), _UNCHANGED, _DAMPING, iterations=_ROUNDS, tolerance=_ENOUGH
        )
        return refit.cost

    def linear_strength(self, laws: list[Law], without: list[Law] | None = None) -> float:
        """Return :meth:`strength` for a refit by one linear step: fast, and rarely smaller.

        ``without`` are laws that replace the plain actuator as the reference.
        """
        reading = self._disturbed(laws)
        reference = self.plain if without is None else self._disturbed(without)
        if reading is None or reference is None:
            return np.inf
        _, residual = _project(self.basis, reading - reference)
        return _rms(residual) / self._parameters.sensor.noise

    def _disturbed(self, laws: list[Law]) -> Array | None:
        sensor = self._parameters.sensor
        rig = Rig(self._parameters, seed=0, effects=laws)
        reading = rig.respond(self._counts)[_SETTLING:]
        inside = (reading > sensor.range_low) & (reading < sensor.range_high)
        return reading if inside.all() and not rig.fault else None

    def linearised(self, shift: Array, response: Array) -> Array:
        """Return what small changes of everything that is free add to ``response``, by column."""
        sensitivities = [
            (self.respond(shift + _STEP * unit) - response) / _STEP for unit in np.eye(len(_FREE))
        ]
        return np.column_stack([*sensitivities, response, np.ones_like(response)])

    def respond(self, shift: Array) -> Array:
        """Return the plain reading with the free parameters changed by factors exp(shift)."""
        film = self._parameters.film
        factors = dict(zip(_FREE, np.exp(shift), strict=True))
        changed = {name: getattr(film, name) * factor for name, factor in factors.items()}
        parameters = replace(self._parameters, film=film._replace(**changed))
        return Rig(parameters, seed=0).respond(self._counts)[_SETTLING:]


class _Refit:
    """The refit of the plain actuator to a disturbed reading, with scale and offset projected out.

    Variable projection (Kaufman, BIT 15, 1975). Gain, stiffness and scale nearly replace one
    another, so that Gauss-Newton steps without damping diverge.
    """

    def __init__(self, yardstick: Yardstick, reading: Array) -> None:
        self._yardstick, self._reading = yardstick, reading

    def evaluate(self, x: Array) -> Point[Array]:
        """Return the RMS residual at the changes ``x`` of the logarithms, and the response."""
        response = self._yardstick.respond(x) if x.any() else self._yardstick.plain
        linear = np.column_stack([response, np.ones_like(response)])
        return Point(x, _rms(_project(linear, self._reading)[1]), response)

    def linearise(self, point: Point[Array], iteration: int, exact: bool) -> Model:
        """Return the model with scale and offset projected out, its steps limited in length."""
        yardstick = self._yardstick
        basis = yardstick.linearised(point.x, point.value) if iteration else yardstick.basis
        linear = basis[:, len(_FREE) :]
        (scale, _), residual = _project(linear, self._reading)
        slopes = scale * basis[:, : len(_FREE)]
        slopes = slopes - linear @ np.linalg.lstsq(linear, slopes, rcond=None)[0]
        size = np.linalg.norm(slopes, axis=0)
        normal = (slopes / size).T @ (slopes / size)

        def step(damping: float) -> Array:
            damped = normal + damping * np.eye(len(_FREE))
            change: Array = np.linalg.solve(damped, (slopes / size).T @ residual) / size
            change /= max(1.0, np.abs(change).max() / _LONGEST)
            return change

        return Model(point.cost, step)


def _project(basis: Array, values: Array) -> tuple[Array, Array]:
    """Return the least-squares coefficients of ``values`` on ``basis``, and the residual."""
    scale = np.linalg.norm(basis, axis=0)
    coefficients, *_ = np.linalg.lstsq(basis / scale, values, rcond=1e-7)
    residual: Array = values - (basis / scale) @ coefficients
    return coefficients / scale, residual


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
