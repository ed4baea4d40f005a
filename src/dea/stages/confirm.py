"""Set the frequency responses of a tracked model against those measured without a model."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def confirm(
    settings: Mapping[str, Any], probed: Path, model: Path, track: Path, gfrf: Path,
    confirmation: Path,
) -> None:  # fmt: skip
    """Write ``confirmation.nc`` of one actuator from its probed record."""
    from dea import store
    from dea.errors import InputError
    from dea.gfrf import modelled_stretches
    from dea.narx import NarxModel
    from dea.nonparametric import confirmation as confirmed
    from dea.nonparametric import estimates
    from dea.tracking import with_constant

    record = store.read_record(probed)
    narx = with_constant(NarxModel.load(model))
    tracked = store.read(track).sel(tracker=settings["gfrf"]["tracker"])
    measured = estimates(record)
    f = measured.dataset["frequency"].values
    responses = store.read(gfrf)
    highest = float(responses["frequency"].values[responses["excited"].values == 1].max())
    if f[0] > highest:
        raise InputError(
            f"its first line, {f[0]:g} Hz, lies above {highest:.3g} Hz, where the band of the model"
            " ends",
            file=probed,
            field="excitation.probing.lowest",
            remedy="Lower it, and record again",
        )
    modelled = modelled_stretches(
        narx, tracked, responses, measured.stretches, f, store.signals(record).sampling_rate
    )
    result = confirmed(
        measured.dataset, measured.found, modelled, highest, settings["confirmation"]["even_above"]
    )
    result.attrs |= {
        "tracker": settings["gfrf"]["tracker"],
        "estimator": str(tracked["estimator"].values),
        "model_band_withheld": str(tracked["withheld"].values),
    }
    store.write(
        result,
        confirmation,
        title=f"Confirmation of the frequency responses of {settings['system']}",
        inputs={"probed_record": probed, "model": model, "track": track, "gfrf": gfrf},
        settings=settings,
    )


if __name__ == "__main__":
    run(confirm, inputs=("probed", "model", "track", "gfrf"), outputs=("confirmation",))
