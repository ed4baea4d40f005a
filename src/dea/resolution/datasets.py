"""What a resolution found, as a dataset."""

from typing import TYPE_CHECKING

import numpy as np

from dea.effect_label import joined
from dea.resolution.knowledge import Knowledge
from dea.resolution.rounds import Resolution
from dea.store import Described, variable

if TYPE_CHECKING:
    import xarray as xr


def resolution_dataset(found: Resolution, level: float) -> "xr.Dataset":
    """Return probabilities and verdicts before the first designed record and after each.

    Before the round in which a hypothesis came up it has no probability.
    """
    import xarray as xr

    steps = [found.first, *(each.after for each in found.rounds)]
    names = sorted(found.last.posterior.now, key=lambda n: -found.last.posterior.now[n])
    designs = [None, *(each.design for each in found.rounds)]
    unit = found.first.diagnosis.units[1]

    def over(values: list[object], units: str, long_name: str) -> Described:
        text = any(isinstance(value, str) for value in values)
        return variable(
            "round", np.array(values, dtype=object if text else float), units, long_name
        )

    dataset = xr.Dataset(
        {
            "probability": variable(
                ("round", "hypothesis"),
                [[known.posterior.now.get(name, np.nan) for name in names] for known in steps],
                "1",
                "probability of the hypothesis",
            ),
            "rejected": variable(
                ("round", "hypothesis"),
                np.array(
                    [[name in s.posterior.rejected(level) for name in names] for s in steps],
                    np.int8,
                ),
                "1",
                "whether the hypothesis is rejected",
            ),
            "driven": over([s.driven for s in steps], "s", "time driven in designed records"),
            "status": over([_status(s) for s in steps], "1", "verdict on all records so far"),
            "names": over([_names(s) for s in steps], "1", "effects of that verdict"),
            "error_before": over(
                [_error(s, False) for s in steps], unit, "error of the simulation alone"
            ),
            "error_after": over(
                [_error(s, True) for s in steps], unit, "error with the named effects"
            ),
            "form": over([d.form if d else "" for d in designs], "1", "form of the excitation"),
            "closest": over(
                ["/".join(d.closest) if d else "" for d in designs],
                "1",
                "hypotheses that it was hardest to tell apart",
            ),
            "distance": over(
                [d.distance if d else np.nan for d in designs],
                "1",
                "their distance after refit, in standard deviations of the error",
            ),
        },
        coords={
            "round": variable("round", np.arange(len(steps)), "1", "round"),
            "hypothesis": variable(
                "hypothesis",
                np.array(names, dtype=object),
                "1",
                "effects that explain the device",
            ),
        },
        attrs={
            "contract": "resolution",
            "outcome": str(found.outcome),
            "level": level,
            "sentence": found.last.verdict.sentence,
        },
    )
    if found.certificate:
        dataset.attrs |= {
            "certified_before": found.certificate.before,
            "certified_after": found.certificate.after,
        }
    return dataset


def _status(known: Knowledge) -> str:
    verdict = known.verdict
    return f"{verdict.status} in part" if verdict.whole is False else verdict.status


def _names(known: Knowledge) -> str:
    verdict = known.verdict
    return " or ".join(joined(each) for each in (verdict.names, *verdict.rivals) if each)


def _error(known: Knowledge, named: bool) -> float:
    found = known.diagnosis
    fitted = found.extended if named and not known.withdrawn else found.nominal
    return found.problem.seen_rmse(fitted.residual)
