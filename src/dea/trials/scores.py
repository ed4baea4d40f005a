"""The scores of a campaign as one dataset: every trial, and the rates over all trials."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
import xarray as xr

from dea.trials.confidence import acceptable, confidence, risk_coverage
from dea.trials.measures import measures
from dea.trials.opened import Opened
from dea.trials.outcome import OUTCOMES, Label, Said, kind_of, outcome
from dea.trials.proportion import wilson

STRENGTH_EDGES = (3.0, 5.3, 9.5, 17.0, 30.0)  # equal ratios
NO_SINGLE_NAME = ("two effects", "another pair", "none", "ambiguous", "unknown")
Variable = tuple[str | tuple[str, ...], np.ndarray, dict[str, str]]


def scores(
    labels: Mapping[str, Label], verdicts: Mapping[str, Said], family: Mapping[str, str]
) -> xr.Dataset:
    """Score the verdicts on all trials.

    Parameters
    ----------
    labels, verdicts
        What each trial hides and what was said, by the trials' names.
    family
        The class of each effect of the catalogue, by name.

    Returns
    -------
    xr.Dataset
        Contract ``scores``.
    """
    trials = [
        Opened(name, labels[name], said, kind_of(labels[name]), outcome(labels[name], said, family))
        for name, said in verdicts.items()
    ]
    return xr.merge(
        [
            _every_trial(trials),
            _confusion(trials, sorted(set(family) | _hidden_names(trials))),
            _rates(trials),
            _forms(trials),
            _groups(trials, "strength_bin", _strength_bin, _strength_bins()),
            *(
                _groups(trials, f"{what}_kind", partial(_kind, what), _kinds(trials, what))
                for what in ("excitation", "device", "noise")
            ),
            _risk_and_coverage(trials),
        ]
    )  # fmt: skip


def _every_trial(trials: Sequence[Opened]) -> xr.Dataset:
    def names(effects: frozenset[str]) -> str:
        return " + ".join(sorted(effects))

    texts: dict[str, tuple[str, Callable[[Opened], str]]] = {
        "hidden": ("what was hidden", lambda t: names(t.label.effects) or "none"),
        "kind": ("whether one, two, no or a foreign effect was hidden", lambda t: t.kind),
        "forms": ("forms of what was hidden", lambda t: names(frozenset(t.label.forms.values()))),
        "excitation": ("kind of excitation", lambda t: t.label.excitation),
        "device": ("device", lambda t: t.label.device),
        "noise": ("kind of noise", lambda t: t.label.noise),
        "status": ("status of the verdict", lambda t: t.said.status),
        "said": ("names given", lambda t: names(t.said.effects)),
        "rivals": ("names offered instead", lambda t: " or ".join(map(names, t.said.rivals))),
        "outcome": ("what the verdict is worth", lambda t: t.outcome),
    }
    numbers: dict[str, tuple[str, str, Callable[[Opened], float]]] = {
        "strength": ("strength of what is hidden, in noise RMS", "1", lambda t: t.label.strength),
        "confidence": ("confidence in the best explanation", "1", lambda t: confidence(t.said)),
        "truth_error": ("error to the truth, in noise RMS", "1", lambda t: t.said.truth_error),
        "error_before": ("certified error before", "output", lambda t: t.said.error_before),
        "error_after": ("certified error after", "output", lambda t: t.said.error_after),
        "noise_floor": ("noise floor", "output", lambda t: t.said.noise_floor),
    }
    variables = {
        key: ("trial", [value(t) for t in trials], {"units": "1", "long_name": long})
        for key, (long, value) in texts.items()
    } | {
        key: ("trial", [float(value(t)) for t in trials], {"units": unit, "long_name": long})
        for key, (long, unit, value) in numbers.items()
    }
    return xr.Dataset(variables, coords={"trial": [t.name for t in trials]})


def _confusion(trials: Sequence[Opened], catalogue: Sequence[str]) -> xr.Dataset:
    """Count trials by what was hidden and what was said.

    Pairs share a row; its column of the same name counts those whose both effects were named.
    """

    def row(t: Opened) -> str:
        return {"pair": "two effects", "null": "none"}.get(t.kind) or next(iter(t.label.effects))

    def column(t: Opened) -> str:
        if t.said.status != "named":
            return t.said.status
        if len(t.said.effects) == 1:
            return next(iter(t.said.effects))
        return "two effects" if t.outcome == "right name" else "another pair"

    outside = sorted({row(t) for t in trials if t.kind == "outside"})
    rows, columns = [*catalogue, "two effects", "none", *outside], [*catalogue, *NO_SINGLE_NAME]
    counts = np.zeros((len(rows), len(columns)), np.int64)
    worth = np.zeros((len(rows), len(OUTCOMES)), np.int64)
    for t in trials:
        counts[rows.index(row(t)), columns.index(column(t))] += 1
        worth[rows.index(row(t)), OUTCOMES.index(t.outcome)] += 1
    return xr.Dataset(
        {
            "confusion": _counted(("hidden_effect", "said_effect"), counts),
            "effect_outcomes": _counted(("hidden_effect", "possible_outcome"), worth),
        },
        coords={
            "hidden_effect": rows, "said_effect": columns, "possible_outcome": list(OUTCOMES)
        },
    )  # fmt: skip


def _rates(trials: Sequence[Opened]) -> xr.Dataset:
    found = measures(trials)
    shares = [measure.share for measure in found.values()]
    right = [t.said.truth_error for t in trials if t.outcome == "right name"]
    targets = [measure.target for measure in found.values()]
    return xr.Dataset(
        {
            "rate": _share_of("measure", [p.value for p in shares], "share of trials"),
            "rate_low": _share_of("measure", [p.low for p in shares], "lower end, 95 %"),
            "rate_high": _share_of("measure", [p.high for p in shares], "upper end, 95 %"),
            "rate_trials": _counted(("measure",), [p.trials for p in shares]),
            "rate_target": _share_of("measure", targets, "target"),
            "rate_at_most": ("measure", [int(measure.at_most) for measure in found.values()],
                {"units": "1", "long_name": "1 where the rate should stay below its target"}),
            "median_truth_error": ((), float(np.median(right)) if right else np.nan,
                {"units": "1", "long_name": "error to the truth in noise RMS after a right name"}),
        },
        coords={"measure": list(found)},
    )  # fmt: skip


def _groups(
    trials: Sequence[Opened], dim: str, group: Callable[[Opened], str], names: Sequence[str]
) -> xr.Dataset:
    """Count the outcomes of trials with one hidden effect of the catalogue, group by group."""
    single = [t for t in trials if t.kind == "single"]
    counts = np.zeros((len(names), len(OUTCOMES)), np.int64)
    for t in single:
        counts[list(names).index(group(t)), OUTCOMES.index(t.outcome)] += 1
    right = [wilson(int(row[0]), int(row.sum())) for row in counts]
    return xr.Dataset(
        {
            f"{dim}_outcomes": _counted((dim, "possible_outcome"), counts),
            f"{dim}_right": _share_of(dim, [p.value for p in right], "right name"),
            f"{dim}_right_low": _share_of(dim, [p.low for p in right], "lower end, 95 %"),
            f"{dim}_right_high": _share_of(dim, [p.high for p in right], "upper end, 95 %"),
        },
        coords={dim: list(names), "possible_outcome": list(OUTCOMES)},
    )


def _hidden_names(trials: Sequence[Opened]) -> set[str]:
    return {name for t in trials if not t.label.outside for name in t.label.effects}


def _kind(what: str, trial: Opened) -> str:
    return str(getattr(trial.label, what))


def _kinds(trials: Sequence[Opened], what: str) -> list[str]:
    return sorted({_kind(what, t) for t in trials})


def _forms(trials: Sequence[Opened]) -> xr.Dataset:
    """Count the outcomes of single and foreign effects by their form."""
    alone = [t for t in trials if len(t.label.forms) == 1]
    forms = sorted({form for t in alone for form in t.label.forms.items()})
    counts = np.zeros((len(forms), len(OUTCOMES)), np.int64)
    for t in alone:
        counts[forms.index(next(iter(t.label.forms.items()))), OUTCOMES.index(t.outcome)] += 1
    effects = [effect for effect, _ in forms]
    return xr.Dataset(
        {
            "form_effect": ("form", effects, {"units": "1", "long_name": "effect of the form"}),
            "form_outcomes": _counted(("form", "possible_outcome"), counts),
        },
        coords={"form": [form for _, form in forms], "possible_outcome": list(OUTCOMES)},
    )


def _risk_and_coverage(trials: Sequence[Opened]) -> xr.Dataset:
    sureness, coverage, risk = risk_coverage([t.label for t in trials], [t.said for t in trials])
    named = [t for t in trials if t.said.status == "named"]
    wrong = sum(not acceptable(t.label, t.said.effects) for t in named)
    return xr.Dataset(
        {
            "least_confidence": _share_of("rank", sureness, "confidence in the best explanation"),
            "coverage": _share_of("rank", coverage, "share of trials answered"),
            "risk": _share_of("rank", risk, "share of wrong answers"),
            "coverage_of_names": ((), len(named) / len(trials),
                {"units": "1", "long_name": "share of trials given a name"}),
            "risk_of_names": ((), wrong / len(named) if named else np.nan,
                {"units": "1", "long_name": "share of wrong names among those given"}),
        }
    )  # fmt: skip


def _strength_bins() -> list[str]:
    return [f"{a:g}-{b:g}" for a, b in pairwise(STRENGTH_EDGES)]


def _strength_bin(trial: Opened) -> str:
    place = int(np.searchsorted(STRENGTH_EDGES[1:-1], trial.label.strength, side="right"))
    return _strength_bins()[place]


def _counted(dims: tuple[str, ...], counts: object) -> Variable:
    return dims, np.asarray(counts, np.int64), {"units": "1", "long_name": "number of trials"}


def _share_of(dim: str, values: object, long_name: str) -> Variable:
    return dim, np.asarray(values, float), {"units": "1", "long_name": long_name}
