"""The outcome of one verdict against the opened label."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any, Self

KINDS = ("single", "pair", "outside", "null")
OUTCOMES = (
    "right name",  # named exactly what is hidden
    "one of two",  # of two hidden effects one is named, and nothing else
    "right class",  # another name of the same family
    "abstained",  # several names, or unknown
    "missed",  # said that nothing is missing
    "wrong name",
    "right none",  # nothing is hidden, and nothing is missing
)


@dataclass(frozen=True)
class Label:
    """What a trial hides.

    Attributes
    ----------
    effects
        Their names: none, one or two.
    outside
        Whether the effect is none of the catalogue.
    strength
        RMS residual of the refitted plain device over the RMS noise.
    excitation, device, noise
        Their kinds.
    forms
        The forms of the effects, by name.
    defining
        Values that define an effect, by its name and their meaning, in V, s, Hz or the output's
        unit.
    """

    effects: frozenset[str]
    outside: bool
    strength: float
    excitation: str
    device: str = "film"
    noise: str = "white"
    forms: Mapping[str, str] = field(default_factory=dict)
    defining: Mapping[tuple[str, str], float] = field(default_factory=dict)

    @classmethod
    def of(cls, told: Mapping[str, Any], start: float = 0.0) -> Self:
        """Return what a drawn trial tells of itself; times count from ``start`` (s) on."""
        effects = told["effects"]
        return cls(
            effects=frozenset(effect["name"] for effect in effects),
            outside=any(effect["port"] == "outside" for effect in effects),
            strength=told["strength"],
            excitation=told["excitation"],
            device=told["device"],
            noise=str(told["noise"]),
            forms={effect["name"]: effect["form"] for effect in effects},
            defining={
                (effect["name"], meaning): value - start if meaning == "time" else value
                for effect in effects
                for meaning, value in effect["defining"].items()
            },
        )


@dataclass(frozen=True)
class Said:
    """What a diagnosis says.

    Attributes
    ----------
    status
        ``named``, ``none``, ``ambiguous`` or ``unknown``.
    effects
        The names given, empty unless ``named`` or ``ambiguous``.
    rivals
        Sets of names that an ambiguous verdict offers instead.
    ranking
        Sets of names with their errors, the best explanation first, whatever the status.
    error_before, error_after, noise_floor
        Errors on the certified samples, in the output's unit.
    whole
        Whether a ``named`` verdict says that nothing further is missing.
    truth_error
        RMS error to the noise-free truth on the certified samples, over the RMS noise.
    intervals
        95 % intervals of parameters, by the effect's and the parameter's name.
    """

    status: str
    effects: frozenset[str]
    rivals: tuple[frozenset[str], ...]
    ranking: tuple[tuple[frozenset[str], float], ...]
    error_before: float
    error_after: float
    noise_floor: float
    whole: bool = True
    truth_error: float = inf
    intervals: Mapping[tuple[str, str], tuple[float, float]] = field(default_factory=dict)


def effect_set(names: Iterable[str]) -> frozenset[str]:
    """Return names as a set, in which one that is given again, at another port, has its number."""
    seen: Counter[str] = Counter()
    found = []
    for name in names:
        seen[name] += 1
        found.append(name if seen[name] == 1 else f"{name} {seen[name]}")
    return frozenset(found)


def kind_of(label: Label) -> str:
    """Return which of :data:`KINDS` a trial is."""
    if not label.effects:
        return "null"
    if label.outside:
        return "outside"
    return "single" if len(label.effects) == 1 else "pair"


def outcome(label: Label, said: Said, family: Mapping[str, str]) -> str:
    """Return which of :data:`OUTCOMES` a verdict is.

    ``family`` gives the class of each effect of the catalogue. An ambiguous verdict whose every
    alternative is of the right class has found the class; any other is an abstention. Names that
    leave a rest unnamed are judged as the names that they are.
    """
    if said.status == "none":
        return "missed" if label.effects else "right none"
    if said.status == "unknown":
        return "abstained"
    if said.status == "ambiguous":
        alternatives = (said.effects, *said.rivals)
        same = all(_same_class(label, names, family) for names in alternatives)
        return "right class" if same else "abstained"
    if said.effects == label.effects:
        return "right name"
    if said.effects < label.effects:
        return "one of two"
    return "right class" if _same_class(label, said.effects, family) else "wrong name"


def _same_class(label: Label, names: frozenset[str], family: Mapping[str, str]) -> bool:
    if label.outside or not label.effects:
        return False
    # An effect that the catalogue lacks is in a class of its own.
    return sorted(family.get(n, n) for n in names) == sorted(
        family.get(n, n) for n in label.effects
    )
