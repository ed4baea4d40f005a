"""Compare dynamic and polynomial orders on independent data."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.errors import InputError
from dea.stages.command import run


def orders(settings: Mapping[str, Any], record: Path, orders: Path) -> None:
    """Write ``orders.nc`` of one system."""
    from dea import store
    from dea.narx import Forward, compare_orders
    from dea.stages.identification import good_stretches, segment

    identification, choice = settings["identification"], settings["orders"]
    signals = store.signals(store.read_record(record))
    start, end = identification["start"], identification["start"] + identification["length"]
    # A short record spares independent data only by identifying from less than the segment.
    end = min(end, choice.get("start", end))
    if end <= start:
        raise InputError(
            f"the independent data from {end:g} s on leave nothing of the segment from "
            f"{start:g} s on",
            file=record,
            field="orders.start, identification.start",
            remedy="Begin the segment earlier, or the independent data later.",
        )
    part = segment(signals, start, end - start, record)
    later = segment(signals, choice.get("start", end), choice["length"], record, "orders")
    dataset = compare_orders(
        *good_stretches(signals, part, record, identification),
        signals.u[later],
        signals.y[later],
        dynamic=choice["dynamic"],
        polynomial=choice["polynomial"],
        lags=choice["lags"],
        y_units=signals.y_units,
        even_in_input=identification["even_in_input"],
        search=Forward(choice["threshold"], choice["threshold"]),
    )
    dataset.attrs["samples_left_out"] = signals.left_out
    store.write(
        dataset,
        orders,
        title=f"Orders of {settings['system']}",
        inputs={"record": record},
        settings=settings,
        seed=settings["seed"],
    )


if __name__ == "__main__":
    run(orders, inputs=("record",), outputs=("orders",))
