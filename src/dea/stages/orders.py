"""Compare dynamic and polynomial orders on independent data."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def orders(settings: Mapping[str, Any], record: Path, orders: Path) -> None:
    """Write ``orders.nc`` of one system."""
    from dea import store
    from dea.narx import Forward, compare_orders
    from dea.stages.identification import good_stretches, with_independent

    identification, choice = settings["identification"], settings["orders"]
    signals = store.signals(store.read_record(record))
    part, later = with_independent(signals, identification, choice, record)
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
