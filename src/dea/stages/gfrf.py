"""Frequency responses of a tracked model over the whole record."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from dea.stages.command import run


def gfrf(settings: Mapping[str, Any], record: Path, model: Path, track: Path, gfrf: Path) -> None:
    """Compute H1 over time, and H2 and H3 at chosen times, around the middle input."""
    from dea import store
    from dea.errors import InputError
    from dea.gfrf import Grid, response_over_time
    from dea.narx import NarxModel
    from dea.tracking import with_constant

    chosen = settings["gfrf"]
    signals = store.signals(store.read_record(record))
    tracked = store.read(track)["parameter"]
    if chosen["tracker"] not in tracked["tracker"]:
        raise InputError(
            f"{chosen['tracker']!r} has not tracked this record",
            file=track,
            field="gfrf.tracker",
            remedy=f"Choose {' or '.join(tracked['tracker'].values)}, or add it to the trackers",
        )
    options = {name: value for name, value in chosen.items() if name != "tracker"}
    of_grid = {each.name for each in fields(Grid)} & options.keys()
    result = response_over_time(
        with_constant(NarxModel.load(model)),
        tracked.sel(tracker=chosen["tracker"]),
        signals.u,
        signals.sampling_rate,
        grid=Grid(**{name: options.pop(name) for name in of_grid}),
        **options,
    )
    y, u = signals.y_units, signals.u_units
    units = {"y0": y, "input_spectrum": f"{u}^2/Hz", "H1": f"{y}/{u}", "H2": f"{y}/{u}^2"}
    for name, unit in (units | {"H3": f"{y}/{u}^3"}).items():
        result[name].attrs["units"] = unit
    store.write(
        result,
        gfrf,
        title=f"Frequency responses of {settings['system']} over time",
        inputs={"record": record, "model": model, "track": track},
        settings=settings,
    )


if __name__ == "__main__":
    run(gfrf, inputs=("record", "model", "track"), outputs=("gfrf",))
