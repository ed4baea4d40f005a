"""Select the terms of one system's NARX model and say how sure each is."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def select(settings: Mapping[str, Any], record: Path, model: Path) -> None:
    """Write ``model.nc`` of one system."""
    from dea import store
    from dea.narx import inclusion_frequency, select_terms
    from dea.seeds import generator
    from dea.stages.identification import as_found, good_stretches, segment, selection_arguments

    identification = settings["identification"]
    signals = store.signals(store.read_record(record))
    part = segment(signals, identification["start"], identification["length"], record)
    u, y = good_stretches(signals, part, record, identification)
    selection = selection_arguments(identification)
    found = select_terms(u, y, **selection)
    dataset = found.to_dataset(signals.u_units, signals.y_units)
    if identification["resamples"]:
        frequency = inclusion_frequency(
            found.terms,
            u,
            y,
            rng=generator(settings["seed"], "select", settings["system"]),
            resamples=identification["resamples"],
            **selection | {"search": as_found(selection["search"], found)},
        )
        dataset["inclusion_frequency"] = store.variable(
            "term", frequency, "1", "share of block bootstrap selections with the term"
        )
    dataset.attrs["sampling_rate"] = signals.sampling_rate
    dataset.attrs["samples_left_out"] = signals.left_out
    store.write(
        dataset,
        model,
        title=f"NARX model of {settings['system']}",
        inputs={"record": record},
        settings=settings,
        seed=settings["seed"],
    )


if __name__ == "__main__":
    run(select, inputs=("record",), outputs=("model",))
