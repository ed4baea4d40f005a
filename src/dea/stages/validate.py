"""Validate one system's linear and NARX models on the windows of its record."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def validate(settings: Mapping[str, Any], record: Path, model: Path, validation: Path) -> None:
    """Write ``validation.nc`` of one system."""
    from dea import store
    from dea.narx import NarxModel, Windows, linear_model
    from dea.narx import validate as validate_models
    from dea.stages.identification import good_stretches, segment
    from dea.stages.setting_source import settings_told

    identification, choice = settings["identification"], settings["validation"]
    signals = store.signals(store.read_record(record))
    part = segment(signals, identification["start"], identification["length"], record)
    narx = NarxModel.load(model)
    known = good_stretches(signals, part, record, identification)
    linear = linear_model(*known, max(narx.max_lag, 1))
    with settings_told(record, {name: f"validation.{name}" for name in choice}):
        dataset = validate_models(
            {"linear": linear, "narx": narx},
            signals.u,
            signals.y,
            signals.sampling_rate,
            Windows(choice["windows"], choice["before"], choice["max_lag"]),
            (signals.u_units, signals.y_units),
            signals.u_names,
        )
    dataset.attrs["samples_left_out"] = signals.left_out
    store.write(
        dataset,
        validation,
        title=f"Validation of {settings['system']}",
        inputs={"record": record, "model": model},
        settings=settings,
        seed=settings["seed"],
    )


if __name__ == "__main__":
    run(validate, inputs=("record", "model"), outputs=("validation",))
