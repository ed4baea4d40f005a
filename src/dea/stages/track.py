"""Follow the parameters of a model through the whole record."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def track(settings: Mapping[str, Any], record: Path, model: Path, track: Path) -> None:
    """Track with every method of the settings and simulate freely with each."""
    import xarray as xr

    from dea import store
    from dea.narx import NarxModel
    from dea.stages.setting_source import settings_told
    from dea.tracking import METHODS, compare_free_runs, track_parameters

    chosen = settings["tracking"]
    signals = store.signals(store.read_record(record))
    narx = NarxModel.load(model)
    tracks = {}
    for method in (each for each in METHODS if each in chosen["trackers"]):
        own = chosen["trackers"][method]
        with settings_told(record, {name: f"tracking.trackers.{method}.{name}" for name in own}):
            tracks[method] = track_parameters(
                narx,
                signals.u,
                signals.y,
                method=method,
                instants=chosen["instants"],
                sampling_rate=signals.sampling_rate,
                **own,
            )
    with settings_told(record, {"window": "tracking.frozen_window"}):
        free_runs = compare_free_runs(
            narx, tracks, signals.u, signals.y, window=chosen["frozen_window"]
        )
    words = {
        "estimator": "method that the estimate is of",
        "withheld": "why no interval holds",
    }
    together = xr.concat(
        [
            found.assign_coords(tracker=method).assign(
                {
                    name: store.variable((), found.attrs[name], "1", label)
                    for name, label in words.items()
                }
            )
            for method, found in tracks.items()
        ],
        dim="tracker",
        join="exact",
        combine_attrs="drop_conflicts",
        data_vars="all",
    )
    result = xr.merge([together.drop_attrs(deep=False), free_runs], join="exact")
    result["tracker"].attrs = {"units": "1", "long_name": "method of tracking"}
    runs = ("simulated", "simulated_low", "simulated_high")
    for name in ("innovation", *runs, "rmse"):
        result[name].attrs["units"] = signals.y_units
    # Seven digits exceed what any tracker knows and halve the file.
    narrow = ("parameter", "parameter_std", "innovation", *runs)
    result.attrs["samples_left_out"] = signals.left_out
    store.write(
        result.assign({name: result[name].astype("float32") for name in narrow}),
        track,
        title=f"Tracked parameters of {settings['system']}",
        inputs={"record": record, "model": model},
        settings=settings,
    )


if __name__ == "__main__":
    run(track, inputs=("record", "model"), outputs=("track",))
