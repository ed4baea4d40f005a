"""What the datasets of a case say, gathered for a reader."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import floor, isfinite, log10
from typing import Any, NamedTuple

import xarray as xr

from dea.equation import equation_html, equation_text, scaling_text
from dea.number_format import number, written_out
from dea.store import Record, Sources, signals
from dea.terms import Term

_DECIMALS = 4  # of a percentage, at most
_BASELINES = {
    "linear": "linear model with as many lags",
    "hammerstein": "static cubic before one pole",
    "cubic": "static cubic of the input",
    "constant": "the mean output",
}
_STABILITY = {
    "stable": "The model is stable: it settles at every constant input over the record's range, and"
    " stays bounded on random inputs like the record's.",
    "slow": "The model is bounded, and so slow at some input that the record is short for it.",
    "unstable": "The model is not stable on all inputs like the record's: do not simulate other"
    " inputs with it. A longer record, fewer lags or a lower degree may give one that is.",
}


class Score(NamedTuple):
    """How a structure simulates a record that it was not estimated from."""

    name: str
    nmse: float
    rmse: float


@dataclass(frozen=True)
class Findings:
    """The findings of a case, from the files of its results.

    Parameters
    ----------
    sources
        ``record.nc``, ``model.nc``, ``validation.nc``, ``gfrf.nc``; ``test_scores.nc`` where the
        case has test records, ``verdict.json`` where its simulation was diagnosed.
    """

    title: str
    sources: Sources

    @cached_property
    def name(self) -> str:
        """The name of the case."""
        return next(iter(self.sources.datasets("record")))

    @cached_property
    def signals(self) -> Record:
        """The record."""
        return signals(self.sources.dataset("record"))

    @cached_property
    def record(self) -> str:
        """One sentence on the record."""
        record, dataset = self.signals, self.sources.dataset("record")
        *first, last = [f"{name} ({units})" for name, units in record.inputs]
        driving = f"{', '.join(first)} and {last} drive" if first else f"{last} drives"
        left_out = f", {record.left_out} of them missing" if record.left_out else ""
        return (
            f"{record.y.size} samples at {record.sampling_rate:.6g} Hz{left_out}: {driving}"
            f" {record.y_name} ({record.y_units});"
            f" {dataset.attrs['source_file']}."
        )

    @cached_property
    def _model(self) -> xr.Dataset:
        return self.sources.dataset("model")

    @property
    def _terms(self) -> list[Term]:
        return [Term.parse(text) for text in self._model["term"].values.tolist()]

    @property
    def equation(self) -> str:
        """The equation as text, rounded."""
        return equation_text(self._terms, self._model["parameter"].values.tolist())

    @property
    def scaling(self) -> str:
        """What u and y of the equation are, in the units of the record."""
        return scaling_text(*self._signals_and_scaling)

    @property
    def equation_in_html(self) -> str:
        """The equation and the scaling of its signals."""
        return equation_html(
            self._terms, self._model["parameter"].values.tolist(), *self._signals_and_scaling
        )

    @property
    def _signals_and_scaling(
        self,
    ) -> tuple[dict[str, float | Sequence[float]], list[tuple[str, str]], str]:
        names = ("u_offset", "u_scale", "y_offset", "y_scale")
        scaling = {name: self._model[name].values.tolist() for name in names}
        return scaling, self.signals.inputs, self.signals.y_units

    @property
    def stability(self) -> str:
        """One sentence on the stability of the model."""
        return _STABILITY[self._model.attrs["stability"]]

    def scores(self) -> dict[str, list[Score]]:
        """Return the scores by test record, the model's first."""
        if not self.sources.datasets("test_scores"):
            return {}
        scores = self.sources.dataset("test_scores")
        found = {}
        for part in map(str, scores["part"].values):
            one = scores.sel(part=part)
            others = [
                Score(
                    _BASELINES[name],
                    float(one["baseline_nmse"].sel(baseline=name)),
                    float(one["baseline_rmse"].sel(baseline=name)),
                )
                for name in sorted(map(str, one["baseline"].values), key=list(_BASELINES).index)
            ]
            model = Score(f"NARX, {len(self._terms)} terms", float(one["nmse"]), float(one["rmse"]))
            found[part] = [model, *others]
        return found

    @property
    def residuals(self) -> str:
        """What the residuals of the forecasts hold."""
        return str(self.sources.dataset("validation")["verdict"].sel(model="narx").values)

    @property
    def responses_withheld(self) -> str:
        """Why the responses have no bands; empty where they have."""
        return str(self.sources.dataset("gfrf").attrs.get("withheld", ""))

    @property
    def missing_effect(self) -> str:
        """What the simulation is missing; empty where none was diagnosed."""
        return str(self._verdict["sentence"]) if self._verdict else ""

    @property
    def not_offered(self) -> str:
        """Which effects the diagnosis never tried, and why; empty where it tried all."""
        by_reason: dict[str, list[str]] = {}
        for each in self._verdict["not_offered"] if self._verdict else []:
            at = f" at {each['place']}" if each["place"] else ""
            by_reason.setdefault(each["reason"], []).append(f"`{each['name']}`{at}")
        told = [f"{', '.join(names)} ({reason})" for reason, names in by_reason.items()]
        return f"Not tried: {'; '.join(told)}." if told else ""

    @cached_property
    def _verdict(self) -> Mapping[str, Any] | None:
        """The verdict on the simulation of the case, where one was diagnosed."""
        return next(iter(self.sources.documents("verdict").values()), None)


def percentage(nmse: float) -> str:
    """Return the share of the output's variance that a run explains.

    It has a decimal, and as many more as it takes to say that a part is left; three digits where
    the run is far worse than the mean of the output.
    """
    if not isfinite(nmse):
        return number(nmse)
    if nmse >= 1e3:
        return f"{written_out(number(100 * (1 - nmse)))} %"
    decimals = min(max(1, -floor(log10(100 * nmse))), _DECIMALS) if nmse > 0 else _DECIMALS
    explained = round(100 * (1 - nmse), decimals) + 0.0  # zero has no sign
    return f"{explained:.{decimals}f} %"
