"""The controller of the study: the inverse of the tracked model, and feedback through it."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite, nan
from typing import NamedTuple

import numpy as np

from dea.arrays import Array
from dea.control.feedback import FilteredError, Gains
from dea.control.limits import are_limits
from dea.control.online import OnlineTracker
from dea.control.planning import RecedingHorizonInverse
from dea.control.reference import least_jerk
from dea.errors import DeviceError, InputError

# Makes a tracker that begins at these parameters, or at the model's own.
NewTracker = Callable[[Array | None], OnlineTracker]


class LostError(DeviceError):
    """The output does not follow, and no model at hand says how to bring it back."""


class RunIn(NamedTuple):
    """Samples at the start voltage, and samples in which the reference is approached then."""

    hold: int
    approach: int

    def approached(self, reference: Array, measured: float, late: int = 0) -> Array:
        """Return the reference with a way to it from where the output is after the hold.

        The way begins ``late`` samples later, where the output was not known before.
        """
        way = least_jerk((np.arange(reference.size) - self.hold - late) / self.approach)
        begun: Array = measured + (reference - measured) * way
        return begun


@dataclass(frozen=True)
class Guard:
    """What the controller does where the output does not follow; errors are shares of the stroke.

    An error above ``doubt`` puts the model's own parameters in the place of the tracked ones, at
    most once in ``patience`` seconds. An error above ``lost`` for so long ends the drive, and so
    does a sensor that is silent for so long. ``authority`` bounds what the feedback adds to the
    reference.

    No measurement set these values. A controller that follows leaves about a hundredth of the
    stroke, far less than ``doubt``, which acts before ``lost``. A sensor that drops for a second,
    as in the trials of robustness, is waited for.
    """

    doubt: float = 0.25
    lost: float = 0.5
    patience: float = 2.0
    authority: float = 0.3


@dataclass(frozen=True)
class Task:
    """What a controller is to do: the output wanted, (samples,), its stroke, and how it begins.

    The input is ``start`` during the hold of ``run_in``, and stays between the ends of ``limits``.
    Beyond the end of the reference its last output is held.

    Raises
    ------
    InputError
        If the limits are not finite, do not rise, or leave the start outside.
    """

    reference: Array
    stroke: float
    start: float
    run_in: RunIn
    limits: tuple[float, float]

    def __post_init__(self) -> None:
        lowest, highest = self.limits
        if not are_limits(lowest, highest):
            raise InputError(
                f"they are {lowest:g} and {highest:g}",
                field="limits",
                remedy="Give finite ones that rise.",
            )
        if not lowest <= self.start <= highest:
            raise InputError(
                f"{self.start:g} is not from {lowest:g} to {highest:g}, the limits",
                field="start",
                remedy="Begin within them.",
            )


class Silence:
    """Ends a drive whose sensor gives no reading for more than ``longest`` samples in a row."""

    def __init__(self, longest: int) -> None:
        self._longest, self._samples = longest, 0

    def hear(self, measured: float) -> None:
        """Take the output of a sample, not finite if unknown.

        Raises
        ------
        LostError
            Where the sensor has been silent for too long.
        """
        self._samples = 0 if isfinite(measured) else self._samples + 1
        if self._samples > self._longest:
            raise LostError(f"the sensor has given no reading for {self._samples} samples")


class AdaptiveInverse:
    """Feedforward by the inverse of the tracked model, feedback of the error through that inverse.

    The inverse follows r + v, where v = C e is what the feedback C makes of the error e = r - y.
    The loop is closed over the ratio of actuator and model, which is near one where the model is
    right, whatever the gain of the actuator at that voltage is. v is bounded; its integral stands
    still at the bound, and where the input is at a limit.

    Parameters
    ----------
    inverse
        The inverse of the model.
    gains
        Of :meth:`dea.control.ControllerDesign.gains`.
    task
        What to follow.
    new_tracker
        None keeps the model's own parameters.
    renewal
        Samples after which tracking begins anew at the mean of the parameters found in them, so
        that the leakage pulls to what the actuator has become.
    guard
        What to do where the output does not follow.
    """

    def __init__(
        self,
        inverse: RecedingHorizonInverse,
        gains: Gains,
        task: Task,
        *,
        new_tracker: NewTracker | None,
        renewal: int = 3000,
        guard: Guard | None = None,
    ) -> None:
        self._inverse, self._task = inverse, task
        self._guard, self._renewal = guard or Guard(), renewal
        self._patience = round(self._guard.patience * gains.sampling_rate)
        self._silence = Silence(self._patience)
        self._new_tracker = new_tracker
        self._tracker = new_tracker(None) if new_tracker is not None else None
        self._sum, self._summed = np.zeros(1), 0
        self._ahead, self._last, self._sample = np.empty(0), task.start, 0
        self._added, self._feedback = 0.0, FilteredError(gains)
        self._off = self._trusted = 0
        self.fallbacks = 0

    def __call__(self, measured: float) -> float:
        """Return the input of the next sample, given the last output (not finite if unknown).

        Raises
        ------
        LostError
            Where the output does not follow for long, or the sensor is silent.
        """
        k = min(self._sample, self._task.reference.size)
        self._sample += 1
        measured = measured if isfinite(measured) else nan
        self._silence.hear(measured)
        if k < self._task.run_in.hold:
            return self._task.start
        if self._tracker is not None:
            self._tracker.update(self._last, measured)
            self._renew(self._tracker.parameters)
        if not self._ahead.size:
            if not isfinite(measured):
                return self._task.start
            self._begin(k, measured)
        elif isfinite(measured):
            self._feed_back(self._ahead[k - 1] - measured)
        self._last = self._plan_at(k)
        return self._last

    @property
    def reference(self) -> Array:
        """The output wanted, with the way to it from where the output was, shape (samples,)."""
        return self._ahead[: self._task.reference.size]

    def _plan_at(self, k: int) -> float:
        wanted = self._ahead[k : k + self._inverse.horizon] + self._added
        found = None
        if self._tracker is not None:
            found = self._inverse.step(wanted, self._tracker.parameters)
            if found is None:
                self._fall_back()
        if found is None:
            found = self._inverse.step(wanted)
        if found is None:
            raise LostError("the model diverges from where the output is")
        self._inverse.advance()
        return found

    def _renew(self, tracked: Array) -> None:
        self._sum = tracked + self._sum
        self._summed += 1
        if self._summed == self._renewal and self._new_tracker is not None:
            self._track_from(self._sum / self._summed)

    def _track_from(self, parameters: Array | None) -> None:
        if self._new_tracker is not None:
            self._tracker = self._new_tracker(parameters)
        self._sum, self._summed = np.zeros(1), 0

    def _begin(self, k: int, measured: float) -> None:
        run_in = self._task.run_in
        begun = run_in.approached(self._task.reference, measured, k - run_in.hold)
        self._ahead = np.concatenate([begun, np.full(self._inverse.horizon, begun[-1])])
        self._inverse.rest(self._task.start, measured)

    def _feed_back(self, error: float) -> None:
        self._judge(abs(error) / self._task.stroke)
        bound = self._guard.authority * self._task.stroke
        wanted, growth = self._feedback.take(error)
        low, high = self._task.limits
        held = (self._last >= high and growth > 0.0) or (self._last <= low and growth < 0.0)
        if abs(wanted) <= bound and not held:
            self._feedback.integral += growth
        self._added = min(max(wanted, -bound), bound)

    def _judge(self, share: float) -> None:
        self._off = self._off + 1 if share > self._guard.lost else 0
        if self._off > self._patience:
            raise LostError(
                f"the output has been off by more than {self._guard.lost:.0%} of the stroke for"
                f" {self._off} samples"
            )
        self._trusted += 1
        if share > self._guard.doubt and self._trusted > self._patience:
            self._fall_back()

    def _fall_back(self) -> None:
        if self._tracker is not None:
            self.fallbacks += 1
            self._trusted = 0
            self._track_from(None)
