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
    from functools import partial

    import numpy as np

    from dea import nonparametric, store
    from dea.errors import InputError
    from dea.gfrf import frequency_response_band
    from dea.narx import NarxModel
    from dea.tracking import with_constant

    record = store.read_record(probed)
    narx = with_constant(NarxModel.load(model))
    tracked = store.read(track).sel(tracker=settings["gfrf"]["tracker"])
    withheld = str(tracked["withheld"].values)
    measured = nonparametric.best_linear_approximation(record)
    stretches = nonparametric.periods_of(record, float(record.attrs["probing_period"]))
    found = [nonparametric.best_linear(each) for each in stretches]
    f = measured["frequency"].values
    pairs = np.concatenate([-f[::-1], f])
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
    lacking = [
        np.interp(f, responses["frequency"].values, np.nan_to_num(responses[name].values))
        for name in ("model_error_gain", "model_error_phase")
    ]
    modelled = []
    for stretch in stretches:
        now = tracked.sel(instant=stretch.time, method="nearest")
        theta = now["parameter"].sel(time=now["instant"], method="nearest").values.astype(float)
        covariance = now["covariance"].values
        response = partial(
            frequency_response_band,
            narx,
            sampling_rate=store.signals(record).sampling_rate,
            parameters=theta,
            # Without bands of the model the measurement's own decide.
            covariance=np.zeros_like(covariance) if withheld else covariance,
            operating_point=float(stretch.u.mean()),
            allow_missing=True,
        )
        first = response(1, f).widened(lacking[0], np.radians(lacking[1]))
        second = response(2, (pairs[:, None], pairs[None, :]))
        modelled.append(
            nonparametric.Modelled(
                first.response,
                nonparametric.RelativeBand.around(
                    first.response, first.gain_high, first.phase_high
                ),
                second.response,
                nonparametric.RelativeBand.around(
                    second.response, second.gain_high, second.phase_high
                ),
            )
        )
    result = nonparametric.confirmation(measured, found, modelled, highest)
    result.attrs["model_band_withheld"] = withheld
    store.write(
        result,
        confirmation,
        title=f"Confirmation of the frequency responses of {settings['system']}",
        inputs={"probed_record": probed, "model": model, "track": track, "gfrf": gfrf},
        settings=settings,
    )


if __name__ == "__main__":
    run(confirm, inputs=("probed", "model", "track", "gfrf"), outputs=("confirmation",))
