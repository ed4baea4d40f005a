"""Identify published models from records that they simulate, and score the models found."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dea.stages.command import run

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray

    from dea.arrays import Array

_SCORES = {
    "nmse": "SSE/SST of the simulated output on an independent record",
    "h1_error": "relative root mean square error of H1",
    "h2_error": "relative root mean square error of H2",
    "terms_common": "number of the plant's terms that were found",
    "terms_foreign": "number of terms found that the plant does not have",
}


def recover(settings: Mapping[str, Any], models: Path, recovery: Path) -> None:
    """Write ``recovery.nc``: every plant, excitation and search."""
    import numpy as np

    from dea import store
    from dea.excitation import design
    from dea.gfrf import score_recovery
    from dea.narx import Forward, Refined, Scaling, Search, load_published, select_terms
    from dea.seeds import generator

    choice = settings["recovery"]
    rate = choice["sampling_rate"]
    plants = load_published(models)
    # White is the same Gaussian input whose band reaches (almost) half the sampling rate.
    bands = {"coloured": choice["band"], "white": 0.499 * rate}
    excitations = choice["excitation"]
    candidates = {name: choice[name] for name in ("y_lags", "u_lags", "degree")}
    threshold = choice["threshold"]
    searches: dict[str, Search] = {
        "forward": Forward(threshold, threshold),
        "refined": Refined(threshold),
    }
    shape = (len(plants), len(excitations), len(searches))
    scores = {name: np.empty(shape) for name in _SCORES}
    stability = np.empty(shape, dtype="<U10")
    for i, (name, plant) in enumerate(plants.items()):
        for j, excitation in enumerate(excitations):

            def excite(purpose: str, band: float, plant: str = name) -> np.ndarray:
                number = generator(settings["seed"], "recover", plant, purpose).integers(2**31)
                return design(
                    "gaussian",
                    duration=choice["length"],
                    sampling_rate=rate,
                    low=-1.0,
                    high=1.0,
                    seed=int(number),
                    band=band,
                )

            u = excite(f"identify {excitation}", bands[excitation])
            y = plant.simulate(u)
            noise = generator(settings["seed"], "recover", name, excitation, "noise")
            y += choice["noise"] * y.std() * noise.standard_normal(y.size)
            test = excite("test", choice["band"])
            for k, search in enumerate(searches.values()):
                found = select_terms(u, y, scaling=Scaling(), search=search, **candidates)
                stability[i, j, k] = found.status
                result = score_recovery(plant, found, test, rate, choice["band"])
                for score, value in result.items():
                    scores[score][i, j, k] = value
    coords = {
        "plant": list(plants),
        "excitation": list(excitations),
        "search": list(searches),
        "plant_terms": ("plant", [len(plant.terms) for plant in plants.values()]),
    }
    store.write(
        _dataset(scores, stability, coords),
        recovery,
        title="Published models identified from their own simulated records",
        inputs={"models": models},
        settings=settings,
        seed=settings["seed"],
    )


def _dataset(
    scores: Mapping[str, "Array"], stability: "NDArray[np.str_]", coords: Mapping[str, Any]
) -> "xr.Dataset":
    """Return scores and stability by plant, excitation and search."""
    import xarray as xr

    from dea.store import variable

    dimensions = ("plant", "excitation", "search")
    dataset = xr.Dataset(
        {name: variable(dimensions, values, "1", _SCORES[name]) for name, values in scores.items()}
        | {"stability": variable(dimensions, stability, "1", "stable, slow or unstable")},
        coords=coords,
    )
    for coordinate in dataset.coords:
        label = str(coordinate).replace("_", " ")
        dataset[coordinate].attrs.update(units="1", long_name=label)
    return dataset


if __name__ == "__main__":
    run(recover, inputs=("models",), outputs=("recovery",))
