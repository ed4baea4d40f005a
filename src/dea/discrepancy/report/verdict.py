"""The verdict: what a diagnosis says in numbers and words, and ``verdict.json``."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from dea.discrepancy.search.not_offered import NotOffered, Obstacle
from dea.effect_label import joined, parted
from dea.errors import InputError
from dea.strict_json import as_json, from_json


@dataclass(frozen=True)
class Estimate:
    """A parameter's value, unit, 95 % interval, and its prior mean.

    ``origin`` is what its size counts from: for a place, where the motion rests. The interval of a
    value that is ``at_bound`` says little, as the record may ask for a value beyond it. The value
    is ``moved`` standard errors away from its prior mean.
    """

    value: float
    unit: str
    low: float
    high: float
    prior: float
    origin: float = 0.0
    at_bound: bool = False
    moved: float = 0.0


@dataclass(frozen=True)
class Change:
    """A quantity that drifts, at the start and the end of the record."""

    name: str
    unit: str
    start: float
    end: float


@dataclass(frozen=True)
class Bend:
    """How far a curve departs from the straight line fitted to it, at most, and where it does.

    ``largest`` is in ``unit``, the place ``at`` in ``unit_along``; ``slope`` is that of the line.
    """

    name: str
    unit: str
    largest: float
    along: str
    unit_along: str
    at: float
    slope: float


@dataclass(frozen=True)
class NamedEffect:
    """An effect as it is in the extended simulation, with the names of ``verdict.json``.

    Parameters
    ----------
    error_before, error_after
        Free-run errors on held-out blocks without and with it.
    gain
        Logarithm of their ratio with its 95 % interval, which holds over the whole catalogue for
        an effect alone.
    rivals
        The effects of each extension that this record cannot tell from it.
    place
        Name of the force port, or of the input, it acts at, if the simulation has several.
    presence
        Probability that it is part of the answer, whatever else is.
    share
        Part of the misfit that it removes beyond those named before it; none where it was not
        fitted without those named after it.
    change
        Of a drift of one record, what drifts, and its course in two numbers.
    bend
        Of a curve of the reading, how much it bends.
    quoted
        The parameters that tell what it is, the most telling first.
    quantities
        What parameters amount to, where single ones tell nothing: that is stated instead.
    """

    name: str
    port: str
    family: str
    parameters: dict[str, Estimate]
    error_before: float
    error_after: float
    gain: tuple[float, float, float]
    rivals: tuple[tuple[str, ...], ...] = ()
    place: str | None = None
    presence: float = 1.0
    share: float | None = None
    change: Change | None = None
    bend: Bend | None = None
    quoted: tuple[str, ...] = ()
    quantities: dict[str, Estimate] = field(default_factory=dict)


@dataclass(frozen=True)
class Verdict:
    """The outcome of a diagnosis; ``sentence`` says all of it in plain words.

    Errors and levels are RMS values in ``unit``, that of the output.

    Parameters
    ----------
    status
        ``named``, ``ambiguous``, ``none`` or ``unknown``.
    effects
        Those that are named, or lead; with their rivals.
    where
        Where the residual is concentrated before and after, in words and as numbers.
    noise_floor, coloured_level
        Level of the white noise, and of the coloured noise beyond it where there is any.
    certified
        Errors before and after on samples, and on records, that chose nothing.
    ladder
        Held-out errors of the simulation alone and with one named effect more at a time, and the
        noise levels below them.
    equation
        Sparse equation of what is not explained, where something is missing that has no name.
    predictable
        Part of the error that the answer, or where there is none the simulation alone, leaves which
        a flexible model predicts on samples that it was not fitted to.
    not_identifiable
        Effects that this record could not show.
    whole
        Whether the named effects are all of the answer, or a certain part of it; ``None`` where no
        effect is named.
    law_too_poor
        Whether effects named as all of the answer leave more than ``rules.poor`` times what a
        complete simulation leaves on the certified samples, and that is no coloured noise.
    beyond_priors
        The simulation's own parameters, where their values alone explain the record but are outside
        what their priors allow; no effect is named then.
    share
        Part of the misfit that they remove on held-out blocks: its value, low and high.
    presence
        Probability that each of the effects, and of the families, is part of the answer.
    model_error
        What the best explanation leaves: white level, coloured error, its memory in samples, and
        both together.
    remarks
        What a reader must know besides, each a sentence.
    not_offered
        Effects of the catalogue that were never tried on this record, and why.
    """

    status: str
    sentence: str
    effects: tuple[NamedEffect, ...]
    where: dict[str, Any]
    noise_floor: float
    certified: dict[str, Any]
    unit: str
    ladder: dict[str, float] = field(default_factory=dict)
    equation: str | None = None
    predictable: float = 0.0
    not_identifiable: tuple[str, ...] = ()
    whole: bool | None = True
    law_too_poor: bool = False
    beyond_priors: dict[str, Estimate] = field(default_factory=dict)
    share: dict[str, float] | None = None
    presence: dict[str, dict[str, float]] = field(default_factory=dict)
    model_error: dict[str, float] = field(default_factory=dict)
    coloured_level: float = 0.0
    remarks: tuple[str, ...] = ()
    not_offered: tuple[NotOffered, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(effect.name for effect in self.effects)

    @property
    def rivals(self) -> tuple[tuple[str, ...], ...]:
        """Names of the effects of each explanation that may be right instead."""
        return self.effects[0].rivals if self.effects else ()

    def write(self, path: str | Path) -> None:
        """Write ``verdict.json``."""
        from dea.store import atomic

        content = asdict(self)
        for effect in content["effects"]:
            effect["rivals"] = [joined(rival) for rival in effect["rivals"]]
        with atomic(path) as partial:
            partial.write_text(as_json(content, 2) + "\n")


def _estimates(content: Mapping[str, Mapping[str, Any]]) -> dict[str, Estimate]:
    return {name: Estimate(**each) for name, each in content.items()}


def read_verdict(path: str | Path) -> Verdict:
    """Read ``verdict.json``.

    Raises
    ------
    InputError
        If the file is missing, is no verdict, or has the names of an earlier version.
    """
    file = Path(path)
    if not file.exists():
        raise InputError(
            "the file does not exist", file=file, remedy="Correct the path, or diagnose it first"
        )
    try:
        content: Mapping[str, Any] = from_json(file.read_text())
        effects = tuple(
            NamedEffect(
                **{
                    **effect,
                    "parameters": _estimates(effect["parameters"]),
                    "gain": tuple(effect["gain"]),
                    "change": Change(**effect["change"]) if effect.get("change") else None,
                    "bend": Bend(**effect["bend"]) if effect.get("bend") else None,
                    "quoted": tuple(effect.get("quoted", ())),
                    "quantities": _estimates(effect.get("quantities", {})),
                    "rivals": tuple(map(parted, effect["rivals"])),
                }
            )
            for effect in content["effects"]
        )
        return Verdict(
            **{
                **content,
                "effects": effects,
                "beyond_priors": _estimates(content.get("beyond_priors", {})),
                "not_identifiable": tuple(content["not_identifiable"]),
                "remarks": tuple(content["remarks"]),
                "not_offered": tuple(
                    NotOffered(**{**each, "reason": Obstacle(each["reason"])})
                    for each in content["not_offered"]
                ),
            }
        )
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"it is no verdict, or one of an earlier version ({type(error).__name__}: {error})",
            file=file,
            remedy="Make it again",
        ) from error
