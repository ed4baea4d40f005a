"""Frequency responses of a tracked model over the whole record."""

from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Any

from dea.stages.command import run


def gfrf(settings: Mapping[str, Any], record: Path, model: Path, track: Path, gfrf: Path) -> None:
    """Compute H1 over time, and H2 and H3 at chosen times, around the middle input."""
    from dea import store
    from dea.errors import InputError
    from dea.gfrf import Grid, response_over_time
    from dea.narx import Labels, NarxModel
    from dea.tracking import with_constant
    from dea.units import power, product, ratio

    chosen = settings["gfrf"]
    signals = store.signals(store.read_record(record))
    tracked = store.read(track)
    if chosen["tracker"] not in tracked["tracker"]:
        raise InputError(
            f"{chosen['tracker']!r} has not tracked this record",
            file=track,
            field="gfrf.tracker",
            remedy=f"Choose {' or '.join(tracked['tracker'].values)}, or add it to the trackers",
        )
    of_tracker = tracked.sel(tracker=chosen["tracker"])
    options = {name: value for name, value in chosen.items() if name != "tracker"}
    of_grid = {each.name for each in fields(Grid)} & options.keys()
    result = response_over_time(
        replace(with_constant(NarxModel.load(model)), labels=Labels.of(signals)),
        of_tracker,
        signals.u,
        signals.sampling_rate,
        y=signals.y,
        grid=Grid(**{name: options.pop(name) for name in of_grid}),
        **options,
    )
    result.attrs["tracker"] = chosen["tracker"]
    y, driving = signals.y_units, [u for _, u in signals.inputs]
    units = {
        "y0": y,
        "H1": _listed(ratio(y, u) for u in driving),
        "H2": _listed(
            ratio(y, power(u, 2) if u == v else product(u, v))
            for u, v in combinations_with_replacement(driving, 2)
        ),
        "H3": _listed(ratio(y, power(u, 3)) for u in driving),
        "input_spectrum": _listed(ratio(power(u, 2), "Hz") for u in driving),
    }
    for end in ("low", "high"):
        units |= {f"y0_{end}": y, f"gain_{end}": units["H1"], f"H2_gain_{end}": units["H2"]}
    for name, unit in units.items():
        result[name].attrs["units"] = unit
    result.attrs["samples_left_out"] = signals.left_out
    store.write(
        result,
        gfrf,
        title=f"Frequency responses of {settings['system']} over time",
        inputs={"record": record, "model": model, "track": track},
        settings=settings,
    )


def _listed(units: Iterable[str]) -> str:
    """Return the units of every input, or pair of them, in order; one text where all are alike."""
    each = list(units)
    return each[0] if len(set(each)) == 1 else ", ".join(each)


if __name__ == "__main__":
    run(gfrf, inputs=("record", "model", "track"), outputs=("gfrf",))
