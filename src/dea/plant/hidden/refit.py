"""The strength of a hidden effect: what a refitted plain device does not explain of it."""

import numpy as np

from dea.arrays import Array
from dea.least_squares import Damping, Model, Point, minimise
from dea.plant.hidden.devices import DeviceKind, Plain
from dea.plant.hidden.effect import Conditions, Law
from dea.plant.hidden.rig import TrialRig

_STEP = 1e-3  # relative, of the finite differences
_LONGEST = 0.7  # largest change of a parameter's logarithm in one Gauss-Newton step
_ROUNDS = 6
_DAMPING = Damping(first=1e-4, least=0.0, tries=4)  # of the squared sensitivities
_ENOUGH = 0.02  # relative decrease of the residual below which the refit has converged
_SWING = 0.1  # of the travel: a smaller one is no cycle


class Yardstick:
    """Measures the strength of effects on one device under one excitation.

    Parameters
    ----------
    kind, plain
        The device without effects.
    commands, sampling_rate
        The excitation, shape (samples,), in V, and its rate in Hz.
    noise
        RMS of the readings' noise, in the device's unit.

    Attributes
    ----------
    response
        Reading of the plain device, shape (samples,).
    basis
        What small changes of the free parameters, scale and offset add to it, by column.
    """

    def __init__(
        self, kind: DeviceKind, plain: Plain, commands: Array, sampling_rate: float, noise: float
    ) -> None:
        self._kind, self._plain, self._rate, self._noise = kind, plain, sampling_rate, noise
        self._settling = round(kind.settling * sampling_rate)
        self._commands = np.concatenate([np.repeat(commands[:1], self._settling), commands])
        self.size = len(kind.free)
        self.unchanged = np.zeros(self.size)
        self.response = self.respond(self.unchanged)
        self.basis = self.linearised(self.unchanged, self.response)

    def conditions(self) -> Conditions:
        """Return what the excitation does to the plain device."""
        rest, stiffness = self._plain.rest_and_stiffness()
        plain = self.response
        bottom, top = float(plain.min()), float(plain.max())
        swings = _swings(plain, _SWING * (top - bottom))
        return Conditions(
            low=float(self._commands.min()),
            high=float(self._commands.max()),
            rest=rest,
            bottom=bottom,
            median=float(np.median(plain)),
            top=top,
            stiffness=stiffness,
            duration=plain.size / self._rate,
            time=self._kind.time,
            cycles=0.5 * len(swings),
            full_cycles=0.5 * sum(swings) / (top - bottom),
            path=float(np.abs(np.diff(plain)).sum()),
            rate=self._rate,
            power=self._kind.power,
            force=self._kind.force,
        )

    def strength(self, laws: list[Law]) -> float:
        """Return the RMS residual of the refitted plain device over the RMS noise.

        The free parameters, and scale and offset of the reading, are refitted. Infinite where the
        effect breaks the device.
        """
        reading = self._disturbed(laws)
        return np.inf if reading is None else self.unexplained(reading) / self._noise

    def unexplained(self, reading: Array) -> float:
        """Return the RMS residual of the plain device refitted to a reading."""
        refit = minimise(
            _Refit(self, reading), self.unchanged, _DAMPING, iterations=_ROUNDS, tolerance=_ENOUGH
        )
        return refit.cost

    def linear_strength(self, laws: list[Law], without: list[Law] | None = None) -> float:
        """Return :meth:`strength` for a refit by one linear step: fast, and rarely smaller.

        ``without`` are laws that replace the plain device as the reference.
        """
        reading = self._disturbed(laws)
        reference = self.response if without is None else self._disturbed(without)
        if reading is None or reference is None:
            return np.inf
        _, residual = _project(self.basis, reading - reference)
        return _rms(residual) / self._noise

    def _disturbed(self, laws: list[Law]) -> Array | None:
        rig = TrialRig(self._plain, laws, self._rate)
        reading = rig.respond(self._commands)[self._settling :]
        return reading if np.isfinite(reading).all() and not rig.broken else None

    def linearised(self, shift: Array, response: Array) -> Array:
        """Return what small changes of everything that is free add to ``response``, by column."""
        sensitivities = [
            (self.respond(shift + _STEP * unit) - response) / _STEP for unit in np.eye(self.size)
        ]
        return np.column_stack([*sensitivities, response, np.ones_like(response)])

    def respond(self, shift: Array) -> Array:
        """Return the plain reading with the free parameters changed by factors exp(shift)."""
        factors = dict(zip(self._kind.free, np.exp(shift).tolist(), strict=True))
        rig = TrialRig(self._plain.changed(factors), [], self._rate)
        return rig.respond(self._commands)[self._settling :]


class _Refit:
    """The refit of the plain device to a disturbed reading, with scale and offset projected out.

    Variable projection (Kaufman, BIT 15, 1975). Gain, stiffness and scale nearly replace one
    another, so that Gauss-Newton steps without damping diverge.
    """

    def __init__(self, yardstick: Yardstick, reading: Array) -> None:
        self._yardstick, self._reading = yardstick, reading

    def evaluate(self, x: Array) -> Point[Array]:
        """Return the RMS residual at the changes ``x`` of the logarithms, and the response."""
        response = self._yardstick.respond(x) if x.any() else self._yardstick.response
        if not np.isfinite(response).all():
            # Such changes break the device.
            return Point(x, np.inf, response)
        linear = np.column_stack([response, np.ones_like(response)])
        return Point(x, _rms(_project(linear, self._reading)[1]), response)

    def linearise(self, point: Point[Array], iteration: int, exact: bool) -> Model:
        """Return the model with scale and offset projected out, its steps limited in length.

        The slopes are those of the plain device until they no longer help.
        """
        yardstick, size = self._yardstick, self._yardstick.size
        here = exact or not iteration
        basis = yardstick.basis
        if exact and iteration:
            basis = yardstick.linearised(point.x, point.value)
        linear = np.column_stack([point.value, np.ones_like(point.value)])
        (scale, _), residual = _project(linear, self._reading)
        slopes = scale * basis[:, :size]
        slopes = slopes - linear @ np.linalg.lstsq(linear, slopes, rcond=None)[0]
        length = np.linalg.norm(slopes, axis=0)
        unit = slopes / length
        normal = unit.T @ unit

        def step(damping: float) -> Array:
            damped = normal + damping * np.eye(size)
            change: Array = np.linalg.solve(damped, unit.T @ residual) / length
            change /= max(1.0, np.abs(change).max() / _LONGEST)
            return change

        return Model(point.cost, step, exact=here)


def _project(basis: Array, values: Array) -> tuple[Array, Array]:
    """Return the least-squares coefficients of ``values`` on ``basis``, and the residual."""
    scale = np.linalg.norm(basis, axis=0)
    coefficients, *_ = np.linalg.lstsq(basis / scale, values, rcond=1e-7)
    residual: Array = values - (basis / scale) @ coefficients
    return coefficients / scale, residual


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _swings(signal: Array, least: float) -> list[float]:
    """Return the lengths of the swings that one longer than ``least`` ends."""
    lengths: list[float] = []
    start = extreme = float(signal[0])
    direction = 1.0
    for value in signal.tolist():
        if (value - extreme) * direction > 0.0:
            extreme = value
        elif abs(value - extreme) > least:
            lengths.append(abs(extreme - start))
            start, extreme, direction = extreme, value, -direction
    return lengths
