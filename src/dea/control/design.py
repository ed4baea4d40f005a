"""Controllers of one actuator, designed from its record and model, and what they are to follow."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dea.arrays import Array
from dea.control.adaptive_inverse import AdaptiveInverse, Guard, RunIn, Silence, Task
from dea.control.feedback import Follower, Gains, tune_feedback
from dea.control.limits import InputLimits
from dea.control.online import OnlineTracker, scale_of_record
from dea.control.planning import RecedingHorizonInverse, inverse_of
from dea.control.reference import ReferenceShape, design_reference, reach_of
from dea.control.through_inverse import band_through_inverse
from dea.control.whole_inverse import InverseInputs, whole_inverse
from dea.errors import InputError
from dea.gfrf import ResponseBand, frequency_response_band, zero_input_response
from dea.missing import filled
from dea.narx import NarxModel, rate_of
from dea.tracking import with_constant

Controller = Callable[[float], float]
RESTS = 3  # over the reach, at which margins are kept: both ends and the middle
# s for which an input of a simulation acts in the steps to its inverse: a longer memory is left to
# the next step, so that this changes how many steps there are, and not where they end.
_MEMORY = 0.5
_CHANGE = 1e-3  # of the inputs' scale: its effect is linear, and far above rounding
_TRIED = 200  # inputs between the limits, among which rests are looked for
# s, integral times that are tried for PI, in factors of two; the best is taken.
_TIMES = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6)


@dataclass(frozen=True)
class ControllerDesign:
    """What controllers of an actuator are made from.

    Parameters
    ----------
    model
        Of the actuator, or of another one.
    scale
        Of the regressors of the tracker, shape (terms,).
    task
        What they follow.
    rests
        Input and output of the model's rests over the reach.
    settings
        The section ``control`` of the config.
    sampling_rate
        In Hz.
    """

    model: NarxModel
    scale: Array
    task: Task
    rests: list[tuple[float, float]]
    settings: Mapping[str, Any]
    sampling_rate: float

    @classmethod
    def of_record(
        cls,
        model: NarxModel,
        u: Array,
        y: Array,
        sampling_rate: float,
        settings: Mapping[str, Any],
        seed: int,
    ) -> "ControllerDesign":
        """Return a design over what a record (u, y) of the actuator reached.

        Raises
        ------
        InputError
            If the record's minutes have no range in common, or the model has no rests there at
            which its output rises with its input, or the rate is not the model's own.
        """
        rate_of(model.labels, sampling_rate)
        chosen = settings["reference"]
        reach = reach_of(y, sampling_rate, (chosen["shares"][0], chosen["shares"][1]))
        limits = float(np.nanmin(u)), float(np.nanmax(u))
        run_in = RunIn(*(round(settings[name] * sampling_rate) for name in ("hold", "approach")))
        followed = design_reference(
            reach, round(settings["duration"] * sampling_rate), sampling_rate, seed,
            ReferenceShape(*(chosen[name] for name in ReferenceShape._fields)),
        )  # fmt: skip
        reference = np.concatenate([np.full(sum(run_in), followed[0]), followed])
        rests = rests_of(model, limits, np.linspace(reach.low, reach.high, RESTS))
        middle = 0.5 * (reach.low + reach.high)
        start = min(rests, key=lambda rest: abs(rest[1] - middle))[0]
        scale = scale_of_record(model, filled(u)[0], y)
        task = Task(reference, reach.stroke, start, run_in, limits)
        return cls(model, scale, task, rests, settings, sampling_rate)

    def inverse(self) -> RecedingHorizonInverse:
        """Return a new inverse of the model."""
        lowest, highest = self.task.limits
        return RecedingHorizonInverse(
            self.model, horizon=self.settings["horizon"], smoothness=self.settings["smoothness"],
            lowest=lowest, highest=highest, rate=self.settings["rate"],
            sampling_rate=self.sampling_rate,
        )  # fmt: skip

    def gains(self) -> Gains:
        """Return the feedback through the inverse, tuned at every rest for its band of H1."""
        inverse = self.inverse()
        z = np.exp(2j * np.pi * loop_frequencies(self.sampling_rate) / self.sampling_rate)
        bands = [band_through_inverse(inverse, u, y, self._band(u), z) for u, y in self.rests]
        return self._tuned(bands, self.settings["integral_time"], self.settings["filter_time"])

    def adaptive(self, gains: Gains) -> AdaptiveInverse:
        """Return the controller whose model is tracked."""
        renewal = round(self.settings["adaptation"]["renewal"] * self.sampling_rate)
        return AdaptiveInverse(
            self.inverse(), gains, self.task, new_tracker=self._tracker, renewal=renewal
        )

    def fixed(self, gains: Gains) -> AdaptiveInverse:
        """Return the same controller with the model as it is."""
        return AdaptiveInverse(self.inverse(), gains, self.task, new_tracker=None)

    def feedforward(self) -> Array:
        """Return the inputs of the fixed model's inverse alone, shape (samples,)."""
        hold = self.task.run_in.hold
        start = min(self.rests, key=lambda rest: abs(rest[0] - self.task.start))
        wanted = self.task.run_in.approached(self.task.reference, start[1])
        inverse = inverse_of(self.inverse(), wanted[hold:], *start)
        return np.concatenate([np.full(hold, start[0]), inverse])

    def inverse_of_simulation(self, simulate: Callable[[Array], Array]) -> InverseInputs:
        """Return the inputs with which a simulation of the actuator follows the reference.

        ``simulate`` makes outputs of inputs, both of shape (samples,) and in the units of the
        task. The reference is approached from where the simulation is after the hold.
        """
        task, hold = self.task, self.task.run_in.hold
        scaling = self.model.of_one_input("A controller")
        held = simulate(np.full(hold + 1, task.start))[-1]
        wanted = task.run_in.approached(task.reference, held)
        wanted[:hold] = np.nan
        return whole_inverse(
            simulate, wanted, np.full(wanted.size, task.start),
            memory=round(_MEMORY * self.sampling_rate),
            change=_CHANGE * scaling.u_scale,
            weight=self.settings["smoothness"] * (scaling.y_scale / scaling.u_scale) ** 2,
            limits=InputLimits(*task.limits, self.settings["rate"] / self.sampling_rate),
        )  # fmt: skip

    def proportional_integral(self) -> Gains:
        """Return the gains of PI control, tuned on the linear model.

        At each integral time tried the gain is the largest that keeps the margins at every rest;
        of these the one with the largest integral gain is taken, which removes slow disturbances
        best (Astroem and Haegglund, Advanced PID Control, 2006, section 4.9).
        """
        delay = np.exp(-2j * np.pi * loop_frequencies(self.sampling_rate) / self.sampling_rate)
        linear = [ResponseBand.exact(self._band(u).response * delay) for u, _ in self.rests]
        tuned = [self._tuned(linear, time) for time in _TIMES]
        return max(tuned, key=lambda gains: abs(gains.proportional) / gains.integral_time)

    def follower(self, gains: Gains) -> "FromStart":
        """Return feedback alone."""
        lowest, highest = self.task.limits
        follower = Follower(gains, lowest, highest, self.settings["rate"], self.task.start)
        return FromStart(follower, self.task)

    def _band(self, u: float) -> ResponseBand:
        """Return the band of H1 around the rest at an input."""
        frequencies = loop_frequencies(self.sampling_rate)
        return frequency_response_band(
            self.model, 1, frequencies, self.sampling_rate, operating_point=u
        )

    def _tuned(
        self, bands: list[ResponseBand], integral_time: float, filter_time: float = 0.0
    ) -> Gains:
        """Return the largest gain that keeps its margins for all bands, one of each rest."""
        tuned = [
            tune_feedback(
                band, loop_frequencies(self.sampling_rate), self.sampling_rate,
                integral_time=integral_time, filter_time=filter_time,
                largest_sensitivity=self.settings["largest_sensitivity"],
            )
            for band in bands
        ]  # fmt: skip
        return min(tuned, key=lambda gains: abs(gains.proportional))

    def _tracker(self, parameters: Array | None) -> OnlineTracker:
        model = with_constant(self.model)
        begun = model if parameters is None else model.with_parameters(parameters)
        names = ("forgetting", "leakage", "delta")
        chosen = {name: self.settings["adaptation"][name] for name in names}
        return OnlineTracker(begun, self.scale, **chosen)


class FromStart:
    """A follower that begins with the run-in of a task, and ends where its sensor is silent."""

    def __init__(self, follower: Follower, task: Task) -> None:
        self._follower, self._task, self._sample = follower, task, 0
        self._silence = Silence(round(Guard().patience * follower.gains.sampling_rate))
        self.reference = np.empty(0)

    def __call__(self, measured: float) -> float:
        """Return the input of the next sample, given the last output (not finite if unknown).

        Raises
        ------
        LostError
            Where the sensor is silent for two seconds.
        """
        self._silence.hear(measured)
        k, hold = min(self._sample, self._task.reference.size), self._task.run_in.hold
        self._sample += 1
        if k < hold or not (self.reference.size or np.isfinite(measured)):
            return self._task.start
        if not self.reference.size:
            self.reference = self._task.run_in.approached(self._task.reference, measured, k - hold)
        return self._follower.step(self.reference[k - 1], measured, self._task.start)


def loop_frequencies(sampling_rate: float) -> Array:
    """Return the frequencies (Hz) at which a loop is looked at, up to half the sampling rate."""
    half = 0.5 * sampling_rate
    low, high = np.geomspace(4e-4 * half, 0.08 * half, 60), np.linspace(0.084, 0.996, 80) * half
    return np.concatenate([low, high])


def rests_of(
    model: NarxModel, limits: tuple[float, float], outputs: Array
) -> list[tuple[float, float]]:
    """Return input and output of the model's rests nearest to these outputs, each once.

    Only rests between the limits count at which the output rises with the input.

    Raises
    ------
    InputError
        If there are none.
    """
    inputs = np.linspace(*limits, _TRIED)
    found = np.array(
        [float(zero_input_response(model, operating_point=u, allow_missing=True)) for u in inputs]
    )
    rising = np.flatnonzero(np.diff(found) > 0.0)
    if not rising.size:
        raise InputError(
            f"it rests at no output that rises with inputs from {limits[0]:g} to {limits[1]:g}",
            field="model",
            remedy="Identify it from a record that reaches as far, of an output that rises.",
        )
    nearest = {int(rising[np.argmin(np.abs(found[rising] - y))]) for y in outputs}
    return [(float(inputs[k]), float(found[k])) for k in sorted(nearest)]
