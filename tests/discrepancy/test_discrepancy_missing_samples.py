"""Diagnoses of records in which samples are flagged, whatever these say."""

import numpy as np
from small_search import SEARCH
from synthetic import record

from dea.acquisition import Quality
from dea.discrepancy import Settings, diagnose

OFFERED = ("coulomb_friction", "gain_drift", "sensor_lag", "viscoelastic_creep")


def test_flagged_samples_change_no_name():
    """Every tenth sample and one second are flagged, and what they hold is worth nothing."""
    whole = record([("gain_drift", 1.5)], duration=20.0, seed=3)
    quality = np.zeros(whole.sizes["time"], np.uint8)
    quality[::10] = Quality.STUCK
    quality[500:550] = Quality.SATURATED
    flagged = whole.assign(quality=("time", quality))
    flagged["displacement"] = flagged["displacement"].where(quality == 0, 0.0)
    settings = Settings(effects=OFFERED, budget=SEARCH)
    found = diagnose(flagged, "dea_membrane", settings=settings)
    assert found.verdict.names == ("gain_drift",), found.verdict.sentence
    assert found.verdict.certified["rmse_after"] < 1.3 * found.floor
