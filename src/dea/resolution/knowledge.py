"""What is known of a device after some records, and how far the question is decided."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING

from dea.discrepancy import Diagnosis, Reason, Settings, Status, Verdict
from dea.resolution.design import Forms
from dea.resolution.excitation import Limits
from dea.resolution.explanation import NONE, Explanation
from dea.resolution.law_error import LawError
from dea.resolution.posterior import Posterior
from dea.simulation import Simulation, catalogue

if TYPE_CHECKING:
    import xarray as xr

    from dea.store import Record

ANOTHER = "another"


class ResolutionOutcome(StrEnum):
    """How far the question is decided."""

    DECIDED = "decided"
    PART = "decided in part"
    OUTSIDE = "outside"
    ALONE = "nothing is missing"
    OPEN = "open"
    CONTRADICTED = "contradicted"


# Status and sentence of the verdict where no hypothesis with an effect is left, or none serves.
WITHOUT_NAME = {
    ResolutionOutcome.OUTSIDE: (
        Status.UNKNOWN,
        "No effect of the catalogue explains the designed records.",
    ),
    ResolutionOutcome.ALONE: (Status.NONE, "The simulation alone explains the designed records."),
    ResolutionOutcome.CONTRADICTED: (
        Status.UNKNOWN,
        "What explains the designed records makes the error on a fresh record larger.",
    ),
}


@dataclass(frozen=True)
class Options:
    """How a question is resolved.

    Parameters
    ----------
    records
        Designed records at most.
    duration
        Longest duration of one in s.
    level
        Probability at which the right hypothesis may be rejected, over all rounds together.
    another
        Prior probability of an explanation that was not offered.
    forms
        Forms of excitation that compete: free ones beside fixed ones, fixed ones alone, or none,
        which plays a random one of free form.
    """

    records: int = 3
    duration: float = 120.0
    level: float = 0.01
    another: float = 0.1
    forms: Forms = Forms.FREE


@dataclass(frozen=True)
class Inquiry:
    """What is asked of a device, as :func:`dea.resolution.resolve` is given it."""

    simulation: Simulation
    limits: Limits
    settings: Settings
    options: Options
    workers: int = 1


@dataclass(frozen=True)
class Knowledge:
    """What is known after some records.

    ``explanations`` hold a hypothesis each by its name; ``posterior`` also holds ``another``.
    ``withdrawn`` is the outcome where it leaves no effect, so that no name is given. ``anew`` are
    the hypotheses that were rejected, found at another minimum, and offered a second time.
    """

    records: "tuple[Record | xr.Dataset, ...]"
    diagnosis: Diagnosis
    explanations: Mapping[str, Explanation]
    posterior: Posterior
    error: LawError
    driven: float = 0.0
    withdrawn: ResolutionOutcome | None = None
    anew: frozenset[str] = frozenset()

    @cached_property
    def verdict(self) -> Verdict:
        """The verdict on all records, without a name where no hypothesis with an effect is left."""
        found = self.diagnosis.verdict
        if self.withdrawn is None:
            return found
        status, sentence = WITHOUT_NAME[self.withdrawn]
        return replace(
            found, status=str(status), sentence=sentence, effects=(), share=None, whole=None
        )

    def outcome(self, level: float) -> ResolutionOutcome:
        """Return whether all hypotheses that are left hold the verdict, or none has an effect.

        It is decided where one of them is the verdict, and nothing more.
        """
        left = self.posterior.left(level)
        if left <= {ANOTHER}:
            return ResolutionOutcome.OUTSIDE
        if left == {NONE}:
            return ResolutionOutcome.ALONE
        verdict = self.diagnosis.verdict
        if verdict.status != Status.NAMED or ANOTHER in left:
            return ResolutionOutcome.OPEN
        named = Counter(verdict.names)
        held = [self.explanations[name].effects for name in left]
        if not all(named <= effects for effects in held):
            return ResolutionOutcome.OPEN
        if self.diagnosis.decision.reason is Reason.COLOURED:
            drifts = Counter(each.name for each in catalogue().values() if each.drifts_reading)
            held += [effects - drifts for effects in held]  # which are that noise
        # Where every hypothesis that is left holds more, what is named is a part of the answer.
        return (
            ResolutionOutcome.DECIDED if verdict.whole and named in held else ResolutionOutcome.PART
        )
