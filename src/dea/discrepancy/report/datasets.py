"""A diagnosis as labelled datasets: localisation, candidates and certificate."""

from collections.abc import Iterable

import numpy as np
import xarray as xr

from dea.discrepancy.evidence.law_bands import banded_laws, in_port_unit
from dea.discrepancy.findings import Findings
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.report.sentence import where_sentence
from dea.discrepancy.rules import misfit
from dea.effect_label import joined
from dea.store import Described, Role, variable

_FINISHED = "whether it may be named: fitted to the end, and worse without its essential parameter"
_GAIN = "log ratio of RMSE without and with it, held-out; if unfinished, on the samples fitted to"


def localisation_dataset(diagnosis: Findings) -> xr.Dataset:
    """Return where the residual is concentrated, before and after, along each quantity."""
    where = diagnosis.where
    renamed = [
        piece.rename({d: f"{d}_{when}" for d in piece.dims}).rename(
            {name: f"{name}_{when}" for name in piece.variables if name not in piece.dims}
        )
        for piece, when in ((where.before.dataset, "before"), (where.after.dataset, "after"))
    ]
    return xr.merge(renamed).assign_attrs(
        sentence_before=where_sentence(where.before),
        sentence_after=where_sentence(where.after),
        units=diagnosis.units[1],
        input_units=diagnosis.units[0],
    )


def candidates_dataset(diagnosis: Findings) -> xr.Dataset:
    """Return every effect's gain with its interval, its visibility, and its rivals."""
    unit = diagnosis.units[1]
    singles, gained = diagnosis.singles.candidates, diagnosis.singles.gains
    visible = diagnosis.singles.visibility
    sets, confusion = diagnosis.pool, diagnosis.confusion

    def column(values: list[float] | np.ndarray, units: str, meaning: str) -> Described:
        return variable("candidate", np.asarray(values, float), units, meaning)

    rivals = _written(confusion.candidates)
    data = xr.Dataset(
        {
            "gain": column(gained.gain, "1", _GAIN),
            "gain_low": column(gained.low, "1", "lower end of the 95 % interval over all effects"),
            "gain_high": column(gained.high, "1", "upper end of the 95 % interval"),
            "share": column(
                _shares_alone(diagnosis), "1", "part of the held-out gap that it removes alone"
            ),
            "error": column([c.error for c in singles], unit, "RMSE, charged for parameters"),
            "finished": column([c.finished for c in singles], "1", _FINISHED),
            "visible": column(
                [v.size for v in visible],
                "1",
                "RMS change of the output that the simulation's parameters cannot absorb, over the"
                " noise",
            ),
            "independent": column(
                [v.independent for v in visible], "1", "part of the change that they cannot absorb"
            ),
            "null_gain": variable((), gained.null, "1", "gain that chance exceeds in 5 %"),
            "set_error": variable(
                "set", [c.error for c in sets], unit, "RMSE, charged for parameters"
            ),
            "confusion": variable(
                ("present", "called"),
                confusion.probability,
                "1",
                "probability that one effect is called the other",
            ),
        },
        coords={
            "candidate": ("candidate", _written(singles)),
            "set": ("set", _written(sets)),
            "present": ("present", rivals),
            "called": ("called", rivals),
        },
    )  # fmt: skip
    for name in data.coords:
        data[name].attrs |= {"units": "1", "long_name": f"names of effects ({name})"}
    return data


def certificate_dataset(diagnosis: Findings) -> xr.Dataset:
    """Return the record, both simulations and the use of each sample; other records' errors.

    Of each law that is named, also its course over the record, with a band.
    """
    problem, unit = diagnosis.problem, diagnosis.units[1]
    used = [problem.fit, problem.select, problem.certify]
    role = np.select(used, [Role.FIT, Role.SELECT, Role.CERTIFY], Role.UNUSED)
    data = {
        "input": variable(
            "time" if len(diagnosis.inputs) == 1 else ("time", "signal"),
            problem.u,
            diagnosis.units[0],
            "input",
        ),
        "measured": variable("time", problem.y, unit, "measured output"),
        "nominal": variable(
            "time",
            problem.y - diagnosis.nominal.residual,
            unit,
            "output of the simulation as it was, refitted",
        ),
        "extended": variable(
            "time",
            problem.y - diagnosis.extended.residual,
            unit,
            "output of the extended simulation",
        ),
        "role": (
            "time",
            role.astype(np.int8),
            {
                "units": "1",
                "long_name": "use of the sample",
                "flag_meanings": " ".join(each.name.lower() for each in Role),
            },
        ),
        "noise_floor": variable((), diagnosis.noise_floor, unit, "noise floor"),
        "coloured_level": variable(
            (), diagnosis.coloured_level, unit, "coloured noise beyond the noise floor"
        ),
    }
    if diagnosis.decision.answer:
        data |= _laws(diagnosis)
    names = list(diagnosis.certificate.records)
    for key, meaning in (("before", "without"), ("after", "with")):
        data[f"record_rmse_{key}"] = variable(
            "record",
            np.array([getattr(diagnosis.certificate.records[n], key) for n in names], float),
            unit,
            f"free-run RMSE on another record {meaning} the effects",
        )
    records = len(diagnosis.nominal.records)
    along = "time since the start" if records == 1 else "time, one record after the other"
    coords = {
        "time": variable("time", problem.time, "s", along),
        "record": variable("record", np.array(names, object), "1", "other record"),
    }
    if len(diagnosis.inputs) > 1:
        called = np.array([each.name for each in diagnosis.inputs], object)
        coords["signal"] = variable("signal", called, "1", "name of the input")
    return xr.Dataset(data, coords=coords, attrs={"records": records})


def _laws(diagnosis: Findings) -> dict[str, Described]:
    """Return of each named law what it acts on, what it makes of it with its band, and no law."""
    found = {}
    laws = banded_laws(diagnosis.problem, diagnosis.final, diagnosis.uncertainty.covariance)
    extended = diagnosis.final.extended
    for number, (found_law, attached) in enumerate(zip(laws, extended.attached, strict=True), 1):
        if found_law is not None:
            law = in_port_unit(found_law, extended, attached)
            along, made = law.course.along, law.course.value
            columns = (
                ("along", along.values, along.unit, along.name),
                ("value", made.values, made.unit, made.name),
                ("low", law.low, made.unit, f"{made.name}: lower end of its 95 % band"),
                ("high", law.high, made.unit, f"{made.name}: upper end of its 95 % band"),
                ("idle", law.course.idle, made.unit, "without the law"),
            )
            for part, values, its_unit, meaning in columns:
                found[f"law_{number}_{part}"] = variable("time", values, its_unit, meaning)
    return found


def _shares_alone(diagnosis: Findings) -> np.ndarray:
    """Return the share of each single effect that was fitted to the end; NaN of others."""
    floor, gained = diagnosis.floor, diagnosis.singles.gains

    def share(before: float, gain: float) -> float:
        gap = misfit(before, floor)
        return 1.0 - misfit(before * float(np.exp(-gain)), floor) / gap if gap else np.nan

    candidates = zip(diagnosis.singles.candidates, gained.before, gained.gain, strict=True)
    return np.array([share(*held_out) if c.finished else np.nan for c, *held_out in candidates])


def _written(candidates: Iterable[Candidate]) -> np.ndarray:
    """Return the labels of each candidate's effects, joined."""
    return np.array([joined(c.labels) for c in candidates], dtype=object)
