"""Write a model for controllers and other simulators: C code, and a functional mock-up unit."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def handover(
    settings: Mapping[str, Any], record: Path, model: Path, header: Path, source: Path, unit: Path
) -> None:
    """Write ``header``, ``source`` and ``unit`` of the model, in the units of the record."""
    from dea import store
    from dea.control import c_identifier, to_c, write_fmu
    from dea.narx import NarxModel

    signals = store.signals(store.read_record(record))
    narx = NarxModel.load(model)
    units = signals.unit_of_one_input("A functional mock-up unit")
    name = c_identifier(settings["system"])
    # The times of a record are rounded, its rate is a number that a person chose.
    rate = float(f"{signals.sampling_rate:.9g}")
    to_c(narx, rate, name=name).write(header, source)
    write_fmu(narx, unit, rate, name=name, u_units=units, y_units=signals.y_units)


if __name__ == "__main__":
    run(handover, inputs=("record", "model"), outputs=("header", "source", "unit"))
