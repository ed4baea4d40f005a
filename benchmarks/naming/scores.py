"""Rates of each method, and the tables of the documents."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks.markdown import markdown
from benchmarks.naming.campaign import Said, Tried
from benchmarks.naming.methods import REFERENCE, methods
from dea import trials
from dea.simulation import catalogue
from dea.trials import Label, Proportion, kind_of, outcome, wilson

DASH = "–"
OURS = "diagnosis"
# Part by which an error must be lower to count as lower.
_CLEARLY = 0.05


class Scored(NamedTuple):
    """An answer against the label: the trial's kind, the outcome, and what the error came to."""

    kind: str
    outcome: str
    named: bool
    acceptable: bool  # all names given are hidden
    found: bool  # all that is hidden is among the names given
    ratio: float  # of the unseen error to that of the simulation alone, NaN where that runs away
    seconds: float


def scored(tried: Sequence[Tried], method: str) -> list[Scored]:
    """Score one method's answers."""
    family = {name: str(effect.family) for name, effect in catalogue().items()}
    return [_scored(each, method, family) for each in tried]


def _scored(tried: Tried, method: str, family: dict[str, str]) -> Scored:
    said, label = tried.said[method], tried.label
    named = said.status == "named"
    return Scored(
        kind_of(label),
        outcome(label, _as_verdict(said), family),
        named,
        named and not label.outside and said.effects <= label.effects,
        named and not label.outside and said.effects >= label.effects,
        ratio(tried, method),
        said.seconds,
    )


def ratio(tried: Tried, method: str) -> float:
    """Return the error on what was kept back over that of the simulation alone."""
    alone = tried.said[REFERENCE].error
    return tried.said[method].error / alone if np.isfinite(alone) else np.nan


def _as_verdict(said: Said) -> trials.Said:
    nothing = float("nan")
    return trials.Said(said.status, said.effects, said.rivals, (), nothing, said.error, nothing)


def rates(found: Sequence[Scored]) -> dict[str, Proportion]:
    """Return the shares of one method by their names; those without trials are NaN."""
    of = {kind: [each for each in found if each.kind == kind] for kind in trials.KINDS}

    def share(kind: str, *outcomes: str) -> Proportion:
        return wilson(sum(each.outcome in outcomes for each in of[kind]), len(of[kind]))

    def names(kind: str) -> Proportion:
        return wilson(sum(each.named for each in of[kind]), len(of[kind]))

    given = [each for each in found if each.named]
    return {
        "right name": share("single", "right name"),
        "right name, alone or with another": wilson(
            sum(each.found for each in of["single"]), len(of["single"])
        ),
        "right class": share("single", "right name", "right class"),
        "wrong name": share("single", "wrong name"),
        "no name (`ambiguous`, `unknown`)": share("single", "abstained"),
        "nothing missing, it says": share("single", "missed"),
        trials.BOTH: share("pair", "right name"),
        "one or both of two, nothing wrong": share("pair", "right name", "one of two"),
        trials.ON_NOTHING: names("null"),
        trials.ON_FOREIGN: names("outside"),
        "names given that are right": wilson(sum(each.acceptable for each in given), len(given)),
    }


def ratios(found: Sequence[Scored], missing: bool) -> np.ndarray:
    """Return the ratios of errors where something, or nothing, is missing."""
    kept = np.array([each.ratio for each in found if (each.kind != "null") == missing])
    known: np.ndarray = kept[~np.isnan(kept)]
    return known


def lower(found: Sequence[Scored], ours: Sequence[Scored]) -> Proportion:
    """Return the share of trials, something missing, with a clearly lower error than ours."""
    pairs = [
        (each.ratio, own.ratio)
        for each, own in zip(found, ours, strict=True)
        if each.kind != "null" and not np.isnan([each.ratio, own.ratio]).any()
    ]
    return wilson(sum(each < (1.0 - _CLEARLY) * own for each, own in pairs), len(pairs))


def table(tried: Sequence[Tried]) -> list[str]:
    """Return the rates of every method as lines of Markdown, a column for each."""
    found = {name: scored(tried, name) for name in ranked(tried)}
    shares = {name: rates(each) for name, each in found.items()}
    rows = [
        [measure, *(_share(shares[name][measure]) for name in found)]
        for measure in next(iter(shares.values()))
    ]
    for missing, what in ((True, "something"), (False, "nothing")):
        errors = [_quartiles(ratios(each, missing)) for each in found.values()]
        rows.append([f"unseen error, {what} missing", *errors])
    rows.append(
        [
            f"unseen error lower than that of {methods()[OURS].title}",
            *(
                DASH if name == OURS else _share(lower(each, found[OURS]))
                for name, each in found.items()
            ),
        ]
    )
    rows.append(["time of a processor (s)", *map(_seconds, found.values())])
    failed = [sum(bool(each.said[name].failed) for each in tried) for name in found]
    rows.append(["trials that it failed on", *map(str, failed)])
    return markdown(["measure", *(methods()[name].title for name in found)], rows)


def table_of_answers(tried: Sequence[Tried], names: Sequence[str]) -> list[str]:
    """Return what methods say of each trial, and their unseen errors, as lines of Markdown."""
    rows = [
        [
            f"{each.name} ({_names(each.label)})",
            *(
                f"{_said(each.label, each.said[name])}, {_number(ratio(each, name))}"
                for name in names
            ),
        ]
        for each in tried
    ]
    return markdown(["record", *(methods()[name].title for name in names)], rows)


def ranked(tried: Sequence[Tried]) -> list[str]:
    """Return the methods, those first that give the most right names and the fewest wrong ones."""

    def worth(name: str) -> float:
        found = scored(tried, name)
        right, wrong = (
            sum(each.outcome == what for each in found) for what in ("right name", "wrong name")
        )
        return wrong - right

    return sorted(methods(), key=worth)


def _names(label: Label) -> str:
    return " + ".join(sorted(label.effects)) + ", foreign" * label.outside or "none"


def _number(ratio: float) -> str:
    return DASH if np.isnan(ratio) else f"{ratio:.2f}"


def _said(label: Label, said: Said) -> str:
    names = " + ".join(sorted(said.effects))
    if said.failed:
        return "failed"
    if said.status != "named":
        return f"{said.status}: {names}" if names else said.status
    return f"**{names}**" if said.effects == label.effects else names


def _share(share: Proportion) -> str:
    if not share.trials:
        return DASH
    low, high = 100.0 * share.low, 100.0 * share.high
    return f"{100.0 * share.value:.0f} ({low:.0f} to {high:.0f})"


def _seconds(found: Sequence[Scored]) -> str:
    known = [each.seconds for each in found if not np.isnan(each.seconds)]
    return f"{np.mean(known):.1f}" if known else DASH


def _quartiles(values: np.ndarray) -> str:
    if not values.size:
        return DASH
    low, middle, high = np.quantile(values, [0.25, 0.5, 0.75], method="inverted_cdf")
    return f"{middle:.2f} ({low:.2f} to {high:.2f})"
