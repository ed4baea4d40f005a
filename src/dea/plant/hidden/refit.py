"""How strong an effect is: what a refitted plain actuator cannot explain of it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dea.plant.film import tension
from dea.plant.hidden.effect import Conditions
from dea.plant.parameters import Parameters
from dea.plant.rig import SAMPLE_PERIOD, Law, Rig

Array = NDArray[np.float64]

_FREE = ("permittivity", "yeoh_1", "damping")
_STEP = 1e-3  # relative, of the finite differences
_LONGEST = 0.7  # largest change of a parameter's logarithm in one Gauss-Newton step
_DAMPING = 1e-4  # at first, relative to the squared sensitivities
_ROUNDS = 8
_ENOUGH = 0.02  # relative gain below which the refit has converged
_SETTLING = 100  # samples at the first value before the record begins


class Yardstick:
    """Measures effects on one actuator under one excitation.

    Parameters
    ----------
    parameters
        The plain actuator.
    output_counts
        The excitation, shape (samples,).
    """

    def __init__(self, parameters: Parameters, output_counts: NDArray[np.uint16]) -> None:
        self._parameters = parameters
        self._counts = np.concatenate([np.repeat(output_counts[:1], _SETTLING), output_counts])
        self._origin = np.zeros(len(_FREE))
        self._plain, self._basis = self._linearised(self._origin)

    def conditions(self) -> Conditions:
        """Return what the excitation does to the plain actuator."""
        film = self._parameters.film
        rest = float(Rig(self._parameters, seed=0).respond(np.zeros(1, np.uint16))[0])
        branches = np.ones((film.branch_modulus.size, 2))
        pulls = [tension(film, branches, rest + step, 0.0, 1.0) for step in (-1e-6, 1e-6)]
        command = self._parameters.output_converter.to_values(self._counts)
        return Conditions(
            low=float(command.min()),
            high=float(command.max()),
            rest=rest,
            bottom=float(self._plain.min()),
            median=float(np.median(self._plain)),
            top=float(self._plain.max()),
            stiffness=(pulls[1] - pulls[0]) / 2e-6,
            duration=self._counts.size * SAMPLE_PERIOD,
        )

    def strength(self, laws: list[Law]) -> float:
        """Return the RMS residual of the refitted plain actuator over the RMS noise.

        Gain, stiffness and dashpot of the film, and scale and offset of the reading are free.
        Infinite where the effect breaks the film or leaves the range of the sensor.
        """
        reading = self._disturbed(laws)
        return np.inf if reading is None else self._refit(reading) / self._parameters.sensor.noise

    def linear_strength(self, laws: list[Law], without: list[Law] | None = None) -> float:
        """Return :meth:`strength` for a refit by one linear step: quick, and rarely less.

        ``without`` are laws in the place of the plain actuator: what ``laws`` add to them counts.
        """
        reading = self._disturbed(laws)
        reference = self._plain if without is None else self._disturbed(without)
        if reading is None or reference is None:
            return np.inf
        _, left = _project(self._basis, reading - reference)
        return _rms(left) / self._parameters.sensor.noise

    def _disturbed(self, laws: list[Law]) -> Array | None:
        sensor = self._parameters.sensor
        rig = Rig(self._parameters, seed=0, effects=laws)
        reading = rig.respond(self._counts)[_SETTLING:]
        inside = (reading > sensor.range_low) & (reading < sensor.range_high)
        return reading if inside.all() and not rig.fault else None

    def _refit(self, reading: Array) -> float:
        """Return the RMS of what the best refit leaves of ``reading``.

        Levenberg and Marquardt's method with scale and offset projected out (Kaufman, BIT 15,
        1975): gain, stiffness and scale nearly replace one another, which defeats plain
        Gauss-Newton steps.
        """
        shift, basis = self._origin, self._basis
        linear = basis[:, len(_FREE) :]
        _, left = _project(linear, reading)
        damping, least = _DAMPING, _rms(left)
        for _ in range(_ROUNDS):
            (scale, _), _ = _project(linear, reading)
            slopes = scale * basis[:, : len(_FREE)]
            slopes = slopes - linear @ np.linalg.lstsq(linear, slopes, rcond=None)[0]
            size = np.linalg.norm(slopes, axis=0)
            normal = (slopes / size).T @ (slopes / size)
            before = least
            for _ in range(_ROUNDS):
                damped = normal + damping * np.eye(len(_FREE))
                step = np.linalg.solve(damped, (slopes / size).T @ left) / size
                step /= max(1.0, np.abs(step).max() / _LONGEST)
                tried = self._respond(shift + step)
                _, tried_left = _project(_with_scale_and_offset(tried), reading)
                if _rms(tried_left) < least:
                    damping *= 0.1
                    shift, left, least = shift + step, tried_left, _rms(tried_left)
                    break
                damping *= 10.0
            if before - least < _ENOUGH * before:
                break
            _, basis = self._linearised(shift)
            linear = basis[:, len(_FREE) :]
        return least

    def _linearised(self, shift: Array) -> tuple[Array, Array]:
        """Return the response and what small changes of everything that is free add to it."""
        response = self._respond(shift)
        slopes = [
            (self._respond(shift + _STEP * unit) - response) / _STEP for unit in np.eye(len(_FREE))
        ]
        return response, np.column_stack([*slopes, _with_scale_and_offset(response)])

    def _respond(self, shift: Array) -> Array:
        """Return the plain reading with the free parameters changed by factors exp(shift)."""
        film = self._parameters.film
        factors = dict(zip(_FREE, np.exp(shift), strict=True))
        changed = {name: getattr(film, name) * factor for name, factor in factors.items()}
        parameters = replace(self._parameters, film=film._replace(**changed))
        return Rig(parameters, seed=0).respond(self._counts)[_SETTLING:]


def _with_scale_and_offset(response: Array) -> Array:
    return np.column_stack([response, np.ones_like(response)])


def _project(basis: Array, values: Array) -> tuple[Array, Array]:
    """Return the least-squares coefficients of ``values`` on ``basis``, and what they leave."""
    scale = np.linalg.norm(basis, axis=0)
    coefficients, *_ = np.linalg.lstsq(basis / scale, values, rcond=1e-7)
    return coefficients / scale, values - (basis / scale) @ coefficients


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
