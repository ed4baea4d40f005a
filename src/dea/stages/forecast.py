"""Compare the forecasts of one actuator's NARX model with those of simpler structures."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def forecast(settings: Mapping[str, Any], record: Path, model: Path, forecast: Path) -> None:
    """Write ``forecast.nc`` of one actuator."""
    from dea import store
    from dea.narx import ForecastPlan, NarxModel, baselines, forecast_errors

    signals = store.signals(store.read_record(record))
    narx = NarxModel.load(model)
    dataset = forecast_errors(
        {"narx": narx, **baselines(narx)},
        signals.u,
        signals.y,
        signals.sampling_rate,
        ForecastPlan(**settings["forecast"]),
        signals.y_units,
    )
    dataset.attrs["samples_left_out"] = signals.left_out
    store.write(
        dataset,
        forecast,
        title=f"Forecasts of {settings['system']}",
        inputs={"record": record, "model": model},
        settings=settings,
    )


if __name__ == "__main__":
    run(forecast, inputs=("record", "model"), outputs=("forecast",))
