"""Select one structure for all actuators and say what it costs each in error."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def select_common(
    settings: Mapping[str, Any], records: list[Path], models: list[Path], common: Path
) -> None:
    """Write ``common_model.nc`` from the record and the own model of every actuator."""
    from dea import store
    from dea.narx import NarxModel, compare_structures, select_common_terms
    from dea.stages.identification import (
        common_search,
        good_stretches,
        selection_arguments,
        with_independent,
    )

    identification, orders = settings["identification"], settings["orders"]
    signals = [store.signals(store.read_record(record)) for record in records]
    own = [NarxModel.load(model) for model in models]
    identify, tests = [], []
    for each, record in zip(signals, records, strict=True):
        chosen, later = with_independent(each, identification, orders, record)
        identify.append(good_stretches(each, chosen, record, identification))
        tests.append((each.u[later], each.y[later]))
    selection = selection_arguments(identification)
    selection["search"] = common_search(identification, own)
    found = select_common_terms(identify, **selection)
    dataset = compare_structures(
        {record.parent.name: model for record, model in zip(records, found, strict=True)},
        own,
        tests,
    )
    dataset.attrs["samples_left_out"] = sum(each.left_out for each in signals)
    store.write(
        dataset,
        common,
        title="One structure for all actuators",
        inputs={
            f"{kind}_{file.parent.name}": file
            for kind, files in (("record", records), ("model", models))
            for file in files
        },
        settings=settings,
        seed=settings["seed"],
    )


if __name__ == "__main__":
    run(select_common, inputs=("records*", "models*"), outputs=("common",))
