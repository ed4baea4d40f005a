"""The thresholds of the verdict, and the criteria made of them."""

from dataclasses import dataclass, field, fields
from math import inf
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from dea.errors import InputError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_Value = TypeVar("_Value", int, float)


def at_least(least: int, default: _Value) -> _Value:
    """Return a field of thresholds with a ``default`` that may not be below the ``least``.

    Others may be zero.
    """
    made: _Value = field(default=default, metadata={"least": least})
    return made


@dataclass(frozen=True)
class Rules:
    """When an effect is named.

    A *floor* is what a complete simulation leaves: the noise floor, and beside it the stated
    accuracy or the coloured level; during the search the noise floor alone.

    Parameters
    ----------
    margin
        Part of the held-out error that an effect must remove, at the lower end of its interval. A
        further effect must remove this part of the error on the samples fitted to; the held-out
        error need only fall.
    clean
        Residual, in floors, up to which a record counts as explained.
    misfit
        Part of the gap (the misfit of the simulation alone) that may remain.
    grow
        A further effect is looked for if the residual exceeds this many floors, or the
        misfit exceeds what may remain. Several effects together may not leave more floors, unless
        each is certain and it is coloured noise.
    room
        Part of the gap that is more than the error of a law that is only nearly right: a name that
        leaves more is not all of the answer.
    further
        Part of the gap from which on a further effect is looked for, and accepted if it removes
        most of that. One of the same family needs ``misfit``.
    second
        Part of the remaining misfit that a further effect must remove. A law that is only nearly
        right leaves a small structured residual, part of which almost any second law removes. Also
        the part that each of several effects must remove on the blocks fitted to where one is a
        course in time of the device, and together they leave only noise.
    rival_margin
        A rival of another class is beaten if its misfit is larger by this factor, and the
        difference is significant. A rival to which the evidence leaves hardly any weight is beaten
        by the factor alone, and a pair of effects if its error is larger by it.
    predictable
        A flexible model that lowers the remaining error below this part of it shows that
        something else is missing. Nor is such a residual coloured noise.
    noise_like
        Residual, in floors, up to which a residual that no effect and no flexible model
        reduces counts as noise, and up to which a small drift of the reading counts as noise.
    negligible
        Part of the noise floor below which the misfits of two candidates are not distinguished.
    near
        Candidates with an error up to this factor of the chosen one's are compared with it on
        blocks that neither was fitted to. One whose error on these is larger by more than this is
        no rival of a single effect with nearly all the weight.
    law_error
        Part of the gap that the law of a right effect may leave. A certain part that is named with
        the others of an explanation must remove more than this by itself.
    certain
        Presence from which an effect, or a family of effects, is certain.
    part
        Part of the held-out gap that a certain part must remove, at the lower end of its interval,
        by itself or with the others of the best explanation that holds it, and an effect that the
        evidence alone names, by its value; also the part of what the others leave that each of
        several effects must remove to be named with them, and the part of the residual's energy
        that an explanation must remove for coloured noise that it leaves to count as noise.
    ahead
        Part by which the misfit with a certain set of effects must be lower than with any
        explanation without their family.
    at_bound
        Log-odds that a parameter at its bound costs the presence of its effect: it is often that of
        another effect's law.
    shaped
        Probability that the shape of an effect's law is other than expected in one respect. What
        the law could do besides hardly counts against it.
    likely
        Presence from which an effect, or a family, is called likely. Others are not named, unless
        they leave only noise and their absence is not certain.
    certified
        Part of the gap elsewhere from which an answer must remove the certified gap, too: a limit
        that is seldom reached need not be reached there.
    upheld
        Part of what an answer removes of the gap elsewhere that it must then remove there. What
        bends with noise, as several courses in time do, does not go on so.
    poor
        Certified error, in what a complete simulation leaves, above which a law is called too poor.
    detectable
        An effect is not identifiable from a record if its sensitivity that the simulation's own
        parameters cannot absorb is below this many noise deviations.
    """

    margin: float = 0.10
    clean: float = 1.15
    misfit: float = 0.25
    grow: float = 1.25
    room: float = 0.12
    further: float = 0.03
    second: float = 0.65
    rival_margin: float = at_least(1, 1.05)
    predictable: float = 0.80
    noise_like: float = 1.5
    negligible: float = 0.05
    near: float = at_least(1, 2.5)
    law_error: float = 0.05
    certain: float = 0.9
    part: float = 0.5
    ahead: float = 0.35
    at_bound: float = 3.0
    shaped: float = 0.5
    likely: float = 0.6
    certified: float = 0.5
    upheld: float = 0.4
    poor: float = at_least(1, 1.3)
    detectable: float = 0.2

    def __post_init__(self) -> None:
        require_numbers(self)
        if self.margin >= 0.5:
            raise InputError(
                f"it is {self.margin}", field="margin", remedy="Give less than 0.5: it is doubled"
            )
        if not 0.0 < self.shaped < 1.0:
            raise InputError(
                f"it is {self.shaped}", field="shaped", remedy="Give a probability between 0 and 1"
            )

    @property
    def needed_gain(self) -> float:
        """Gain (log ratio of errors) that removes ``margin`` of the error."""
        return -float(np.log1p(-self.margin))

    def may_follow(self, effects: int = 1) -> float:
        """Return the part of coloured noise that may be predicted beside so many effects.

        Several laws leave little of what they do not explain to be seen.
        """
        return (1.0 - self.predictable) / max(effects, 1)

    def completes(self, error: float, before: float, floor: float) -> bool:
        """Return whether an error is only noise where the error ``before`` was more."""
        return error <= self.clean * floor and before > self.grow * floor

    def removes_energy(self, error: float, before: float) -> bool:
        """Return whether an error leaves no more energy than ``part`` allows of that ``before``."""
        return error**2 <= (1.0 - self.part) * before**2

    def leaves(self, part: float, error: float, nominal_error: float, floor: float) -> bool:
        """Return whether an error leaves more than noise and more than a ``part`` of the gap.

        It must also exceed ``grow`` floors, or leave more than ``misfit`` of the gap.
        """
        if error <= self.clean * floor:
            return False
        left, whole = misfit(error, floor), misfit(nominal_error, floor)
        if left <= part * whole:
            return False
        return error > self.grow * floor or left > self.misfit * whole

    def leaves_room(self, error: float, nominal_error: float, floor: float) -> bool:
        """Return whether an error leaves room for more than the error of a law."""
        return self.leaves(self.room, error, nominal_error, floor)

    def nearly(self, error: float, best: float) -> bool:
        """Return whether an error is the ``best`` one, or nearly so."""
        return error <= self.rival_margin * best

    def as_good(self, error: float, best: float, floor: float) -> bool:
        """Return whether the misfit of an error is that of the ``best`` one, or nearly so."""
        left = max(misfit(best, floor), self.negligible * floor)
        return misfit(error, floor) <= self.rival_margin * left


def require_numbers(thresholds: "DataclassInstance") -> None:
    """Refuse thresholds that are no numbers, too small, or not whole where the default is.

    Raises
    ------
    InputError
        Naming the first.
    """
    for each in fields(thresholds):
        value, whole = getattr(thresholds, each.name), isinstance(each.default, int)
        least = each.metadata.get("least", 0)
        number = isinstance(value, int if whole else int | float) and not isinstance(value, bool)
        if not number or not least <= value < inf:
            kind = "a whole number" if whole else "a number"
            raise InputError(
                f"it is {value!r}", field=each.name, remedy=f"Give {kind} of {least} or more"
            )


def misfit(error: float, floor: float) -> float:
    """Return the part of an error above a floor, √(error² − floor²), and 0 below it.

    Both are RMS values in one unit.
    """
    return float(np.sqrt(max(error**2 - floor**2, 0.0)))
