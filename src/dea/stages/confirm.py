"""Set the frequency responses of a tracked model against those measured without a model."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dea.stages.command import run

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from dea.nonparametric import Band


def confirm(
    settings: Mapping[str, Any], probed: Path, model: Path, track: Path, gfrf: Path,
    confirmation: Path,
) -> None:  # fmt: skip
    """Write ``confirmation.nc`` of one actuator from its probed record."""
    from functools import partial

    import numpy as np

    from dea import nonparametric, store
    from dea.gfrf import frequency_response
    from dea.narx import NarxModel
    from dea.tracking import with_constant

    record = store.read_record(probed)
    rate = store.signals(record).sampling_rate
    narx = with_constant(NarxModel.load(model))
    tracked = store.read(track)["parameter"].sel(tracker=settings["gfrf"]["tracker"])
    responses = store.read(gfrf)
    measured = nonparametric.best_linear_approximation(record)
    stretches = nonparametric.periods_of(record, float(record.attrs["probing_period"]))
    found = [nonparametric.best_linear(each) for each in stretches]
    f = measured["frequency"].values
    pairs = np.concatenate([-f[::-1], f])
    modelled = []
    for stretch in stretches:
        response = partial(
            frequency_response,
            narx,
            sampling_rate=rate,
            parameters=tracked.sel(time=stretch.time, method="nearest").values.astype(float),
            operating_point=float(stretch.u.mean()),
            allow_missing=True,
        )
        H1, H2 = response(1, f), response(2, (pairs[:, None], pairs[None, :]))
        band = _band(responses.sel(time=stretch.time, method="nearest"), f)
        exact = nonparametric.Band(np.zeros(H2.shape), np.zeros(H2.shape))
        modelled.append(nonparametric.Modelled(H1, band, H2, exact))
    excited = responses["frequency"].values[responses["excited"].values == 1]
    store.write(
        nonparametric.confirmation(measured, found, modelled, float(excited.max())),
        confirmation,
        title=f"Confirmation of the frequency responses of {settings['system']}",
        inputs={"probed_record": probed, "model": model, "track": track, "gfrf": gfrf},
        settings=settings,
    )


def _band(response: "xr.Dataset", f: "np.ndarray") -> "Band":
    """Return the band of the stored response at the frequencies ``f``, missing beyond its own."""
    import numpy as np

    from dea.nonparametric import Band

    if "gain_low" not in response:
        return Band(np.zeros(f.size), np.zeros(f.size))

    def at(values: np.ndarray) -> np.ndarray:
        x = np.log(response["frequency"].values)
        return np.asarray(np.interp(np.log(f), x, values, left=np.nan, right=np.nan))

    gain_low, gain_high, phase_low, phase_high = (
        response[name].values for name in ("gain_low", "gain_high", "phase_low", "phase_high")
    )
    H1 = response["H1"]
    gain = np.hypot(H1.sel(part="real").values, H1.sel(part="imag").values)
    return Band(at(0.5 * (gain_high - gain_low) / gain), at(0.5 * (phase_high - phase_low)))


if __name__ == "__main__":
    run(confirm, inputs=("probed", "model", "track", "gfrf"), outputs=("confirmation",))
