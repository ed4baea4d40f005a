"""Diagnoses of records in which samples are flagged, whatever these say."""

import numpy as np
import pytest
from synthetic import record

from dea.acquisition import Quality
from dea.discrepancy import diagnose

pytestmark = pytest.mark.campaign


def test_flagged_samples_change_no_name():
    """Every tenth sample and one second are flagged, and what they hold is worth nothing."""
    whole = record([("gain_drift", 1.5)], duration=40.0, seed=3)
    quality = np.zeros(whole.sizes["time"], np.uint8)
    quality[::10] = Quality.STUCK
    quality[500:550] = Quality.SATURATED
    flagged = whole.assign(quality=("time", quality))
    flagged["displacement"] = flagged["displacement"].where(quality == 0, 0.0)
    found = diagnose(flagged, "dea_membrane")
    assert found.verdict.names == ("gain_drift",), found.verdict.sentence
    assert found.verdict.certified["rmse_after"] < 1.3 * found.floor
