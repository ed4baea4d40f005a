"""What a diagnosis decides."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from dea.discrepancy.evidence.certificate import Certified
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.rules import Rules


class Status(StrEnum):
    """The outcomes of a diagnosis."""

    NAMED = "named"
    NONE = "none"
    AMBIGUOUS = "ambiguous"
    UNKNOWN = "unknown"


class Reason(StrEnum):
    """Why no single effect set is named, or not all of the answer."""

    ACCURATE = "the simulation is as good as it is said to be"
    NOISE = "the residual is at the noise floor"
    IRREDUCIBLE = "no effect and no flexible model reduces the residual"
    COLOURED = "the residual is coloured noise, which follows neither the input nor the motion"
    UNEVEN = "the residual is white noise, above the level of its quietest parts"
    NO_EFFECT = "no effect of the catalogue is sure to reduce the residual"
    UNEXPLAINED = "the best effect leaves too much unexplained"
    REMAINS = "what remains is not named"
    RIVAL = "a rival explains the record as well"
    PRIORS = "the simulation alone explains the record, beyond its declared priors"
    ONLY_CERTIFIED = "only the certified samples show it"
    OF_ONE_RECORD = "the best effect fails on the records left out"
    CONTRADICTED = "the best effect fails on the certified samples"
    CONTRADICTED_ELSEWHERE = "the best effect fails on the test records"


@dataclass(frozen=True)
class Decision:
    """The status, the chosen candidate and, where it is not alone, its rivals.

    An answer that is not ``whole`` is a certain part of it: something else is missing, too. Where
    there is no answer, ``whole`` is ``None``, whatever is given. The reason ``COLOURED`` of a whole
    one says what it leaves. Where samples not used so far have
    withdrawn it, ``contradicted`` holds the errors on those that did, by the name of the record.
    ``freed`` is the simulation alone where its parameters explain the record beyond their priors.
    """

    status: Status
    chosen: Candidate | None
    rivals: tuple[Candidate, ...] = ()
    reason: Reason | None = None
    whole: bool | None = True
    contradicted: Mapping[str, Certified] = field(default_factory=dict)
    freed: Fit | None = None

    def __post_init__(self) -> None:
        if self.answer is None:
            object.__setattr__(self, "whole", None)

    @property
    def answer(self) -> Candidate | None:
        """The candidate that is named, with or without rivals."""
        return self.chosen if self.status in (Status.NAMED, Status.AMBIGUOUS) else None

    def noise(self, rules: Rules, floor: float) -> float:
        """Return the error up to which what an answer leaves is noise, coloured noise included."""
        if self.reason is Reason.COLOURED and self.answer is not None:
            floor = max(floor, self.answer.rmse)
        return rules.clean * floor
