"""Simulate a model freely on records that its identification never saw, and score the runs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def score_tests(settings: Mapping[str, Any], model: Path, test: list[Path], scores: Path) -> None:
    """Write ``test_scores.nc`` of one case; a file's name is the test record's.

    Each run starts from the first measured outputs, as many as the model's largest lag; they are
    not scored.
    """
    import numpy as np
    import xarray as xr

    from dea import store
    from dea.errors import InputError
    from dea.missing import filled
    from dea.narx import NarxModel, nmse, rmse

    narx = NarxModel.load(model)
    start = narx.max_lag
    rows = []
    for file in test:
        signals = store.signals(store.read_record(file))
        if signals.y.size < start + 2:
            raise InputError(
                f"it holds {signals.y.size} samples, of which the model's lags take {start}",
                file=file,
                field="rows",
                remedy="Test on a longer stretch",
            )
        outputs, seen = filled(signals.y)
        scored = np.arange(outputs.size) >= start
        scored &= seen
        run_freely = narx.simulate(signals.u, outputs)[scored]
        measured = outputs[scored]
        rows.append((nmse(measured, run_freely), rmse(measured, run_freely), measured.size))
    columns = zip(*rows, strict=True)
    labels = {
        "nmse": ("1", "SSE/SST of the free run"),
        "rmse": (signals.y_units, "root mean square error of the free run"),
        "samples": ("1", "samples scored, those after the initial outputs"),
    }
    dataset = xr.Dataset(
        {
            name: ("part", np.array(values), {"units": units, "long_name": label})
            for (name, (units, label)), values in zip(labels.items(), columns, strict=True)
        },
        coords={"part": ("part", [file.stem for file in test], {"units": "1"})},
    )
    for name, value, label in (
        ("terms", len(narx.terms), "number of terms"),
        ("initial_outputs", start, "measured outputs that a run starts from"),
    ):
        dataset[name] = ((), value, {"units": "1", "long_name": label})
    store.write(
        dataset,
        scores,
        title=f"Free-run scores of {settings['system']} on its test records",
        inputs={"model": model} | {f"test_{file.stem}": file for file in test},
        settings=settings,
    )


if __name__ == "__main__":
    run(score_tests, inputs=("model", "test*"), outputs=("scores",))
