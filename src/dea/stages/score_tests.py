"""Simulate a model freely on records that its identification never saw, and score the runs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dea.stages.command import run

if TYPE_CHECKING:
    import xarray as xr

    from dea import store
    from dea.narx import NarxModel


def score_tests(
    settings: Mapping[str, Any], record: Path, model: Path, test: list[Path], scores: Path
) -> None:
    """Write ``test_scores.nc`` of one case; a file's name is the test record's.

    Each run starts from the first measured outputs, as many as the largest lag of the model and of
    all simpler structures; they are not scored. Simpler structures are estimated from the segment
    that the model comes from, by the same criterion, and scored alike.
    """
    from dea import store
    from dea.narx import NarxModel, baselines, constant, estimate_refined
    from dea.stages.identification import good_stretches, segment

    narx = NarxModel.load(model)
    identification = settings["identification"]
    known = store.signals(store.read_record(record))
    part = segment(known, identification["start"], identification["length"], record)
    u, y = good_stretches(known, part, record, identification)
    simpler = {
        name: estimate_refined(each.terms, u, y, scaling=narx.scaling)
        for name, each in {"constant": constant(narx), **baselines(narx)}.items()
    }
    start = max(each.max_lag for each in (narx, *simpler.values()))
    rows, others = [], []
    for file in test:
        signals = _signals_like(known, file, start)
        rows.append(_scores(narx, signals, start))
        others.append([_scores(each, signals, start)[:2] for each in simpler.values()])
    dataset = _dataset([file.stem for file in test], rows, list(simpler), others, known.y_units)
    for name, value, label in (
        ("stability", narx.status, "stable, slow or unstable on inputs like those of its segment"),
        ("terms", len(narx.terms), "number of terms"),
        ("initial_outputs", start, "measured outputs that a run starts from"),
    ):
        dataset[name] = store.variable((), value, "1", label)
    store.write(
        dataset,
        scores,
        title=f"Free-run scores of {settings['system']} on its test records",
        inputs={"record": record, "model": model} | {f"test_{file.stem}": file for file in test},
        settings=settings,
    )


def _signals_like(known: "store.Record", file: Path, start: int) -> "store.Record":
    """Return the signals of a test record, checked to be like the ``known`` ones.

    Raises
    ------
    InputError
        If its rate, units or inputs are others, or hardly a sample follows the first ``start``.
    """
    from dea import store
    from dea.errors import InputError
    from dea.narx import Labels

    signals = store.signals(store.read_record(file))
    try:
        Labels.of(known).refuse_other(Labels.of(signals))
    except InputError as error:
        remedy = f"Convert test_records.{file.stem} of the case to what its record is in"
        raise error.at(file=file, remedy=remedy) from error
    if signals.y.size < start + 2:
        raise InputError(
            f"it holds {signals.y.size} samples, of which the lags of the models take {start}",
            file=file,
            field="rows",
            remedy="Test on a longer stretch",
        )
    return signals


def _dataset(
    parts: list[str],
    rows: Sequence[tuple[float, float, int]],
    simpler: list[str],
    others: Sequence[Sequence[tuple[float, float]]],
    y_units: str,
) -> "xr.Dataset":
    """Return the scores of each part, of the model and of the simpler structures."""
    import numpy as np
    import xarray as xr

    from dea import store

    columns = zip(*rows, strict=True)
    labels = {
        "nmse": ("1", "SSE/SST of the free run"),
        "rmse": (y_units, "root mean square error of the free run"),
        "samples": ("1", "samples scored, those after the initial outputs"),
    }
    dataset = xr.Dataset(
        {
            name: store.variable("part", np.array(values), units, label)
            for (name, (units, label)), values in zip(labels.items(), columns, strict=True)
        },
        coords={"part": ("part", parts, {"units": "1"})},
    )
    dataset = dataset.assign_coords(baseline=("baseline", simpler, {"units": "1"}))
    compared = np.moveaxis(np.array(others), -1, 0)
    for name, values in zip(("nmse", "rmse"), compared, strict=True):
        units, label = labels[name]
        dataset[f"baseline_{name}"] = store.variable(
            ("part", "baseline"), values, units, f"{label}, of simpler structures"
        )
    return dataset


def _scores(model: "NarxModel", signals: "store.Record", start: int) -> tuple[float, float, int]:
    """Return nmse, rmse and the number of the samples scored, from sample ``start`` on."""
    import numpy as np

    from dea.missing import filled
    from dea.narx import nmse, rmse

    outputs, seen = filled(signals.y)
    scored = seen & (np.arange(outputs.size) >= start)
    run = model.simulate(signals.u, outputs)[scored]
    measured = outputs[scored]
    return nmse(measured, run), rmse(measured, run), measured.size


if __name__ == "__main__":
    run(score_tests, inputs=("record", "model", "test*"), outputs=("scores",))
