"""Films that several tests of the plant share."""

from pathlib import Path

import numpy as np

from dea.plant.parameters import read_parameters

CONFIG = Path(__file__).parents[2] / "config" / "bench.yaml"
IDEAL = {"electrode_resistance": 1.0, "leak_resistance": 1e18}


def nominal(**changes):
    """Return the first actuator's film without ageing."""
    film = read_parameters(CONFIG, "dea1").film
    still = {"stiffness_ageing": 0.0, "leakage_ageing": 0.0, "electrode_ageing": 0.0}
    return film._replace(**{**still, **changes})


def elastic(**changes):
    """Return a film without branches and with ideal electrodes, stiff enough for 3 kV."""
    none = {"branch_modulus": np.zeros(0), "branch_time": np.zeros(0)}
    return nominal(**{"yeoh_1": 35e3, **none, **IDEAL, **changes})
