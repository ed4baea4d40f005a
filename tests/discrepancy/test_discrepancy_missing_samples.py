"""Diagnoses of records in which samples are flagged, whatever these say."""

import numpy as np
import pytest
from small_search import SEARCH
from synthetic import record

from dea.acquisition import Quality
from dea.discrepancy import Settings, diagnose
from dea.errors import InputError
from dea.store import Record

OFFERED = ("coulomb_friction", "gain_drift", "sensor_lag", "viscoelastic_creep")


@pytest.mark.slow
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
    assert found.verdict.certified["rmse_after"] < 1.3 * found.noise_floor


def test_a_record_whose_output_is_known_too_seldom_is_refused_in_one_line():
    whole = record([], duration=20.0, seed=3)
    known = np.arange(whole.sizes["time"]) < 40
    whole["displacement"] = whole["displacement"].where(known, np.nan)
    with pytest.raises(InputError, match="missing in every block that could be used to certify on"):
        diagnose(whole, "dea_membrane", settings=Settings(effects=OFFERED, budget=SEARCH))


@pytest.mark.parametrize("use", ["fit to", "choose by"])
def test_a_record_without_an_output_in_one_half_is_refused(use):
    """Of 20 s with a warm-up of 1 s the blocks follow one another, one of each half in turn."""
    whole = record([], duration=20.0, seed=3)
    found = diagnose(whole, "dea_membrane", settings=Settings(effects=OFFERED[1:2], budget=SEARCH))
    half = {"fit to": found.split.fit, "choose by": found.split.select}[use]
    whole["displacement"] = whole["displacement"].where(~half, np.nan)
    with pytest.raises(InputError, match=f"missing in every block that could be used to {use}"):
        diagnose(whole, "dea_membrane", settings=Settings(effects=OFFERED, budget=SEARCH))


def test_of_several_records_one_with_too_few_outputs_is_named():
    """Its error alone would be that of no sample, which contradicts any answer."""
    whole, other = (record([], duration=20.0, seed=seed) for seed in (3, 4))
    known = np.arange(other.sizes["time"]) < 5
    other["displacement"] = other["displacement"].where(known, np.nan)
    with pytest.raises(InputError, match="every block of record 2 that could be used to fit to"):
        diagnose([whole, other], "dea_membrane", settings=Settings(effects=OFFERED, budget=SEARCH))


@pytest.mark.parametrize(("role", "keep"), [("input", 0.0), ("output", 1.0)])
def test_a_record_in_which_nothing_happens_is_refused(role, keep):
    u = np.sin(np.arange(400.0))
    still = Record.of(keep * u, (1.0 - keep) * u, 50.0, units=("V", "mm"))
    with pytest.raises(InputError, match=f"{role}: the {role} is constant"):
        diagnose(still, "dea_membrane")


@pytest.mark.parametrize("given", [np.ones(3), "record.nc", None, [1.0]])
def test_what_is_no_record_is_refused(given):
    with pytest.raises(InputError, match=r"record: it is .* Give a dea\.Record"):
        diagnose(given, "dea_membrane")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"workers": 0}, "workers: it is 0. Give at least one"),
        ({"test_records": []}, "test_records: it is list. Give them by name"),
        (
            {"test_records": {"x": np.ones(9)}},
            r"test_records\.x: it is ndarray\. Give a dea\.Record",
        ),
        (
            {"settings": {"effects": ["drag"]}},
            r"settings: it is dict\. Give dea\.discrepancy\.Settings",
        ),
    ],
)
def test_arguments_of_another_kind_are_refused(wrong, words):
    u = np.sin(np.arange(400.0))
    record = Record.of(u, u, 50.0, units=("V", "mm"))
    with pytest.raises(InputError, match=words):
        diagnose(record, "dea_membrane", **wrong)
    several = [record, record]
    with pytest.raises(InputError, match=r"test_records\.record_2: that is the name of a record"):
        diagnose(several, "dea_membrane", test_records={"record_2": record})
    with pytest.raises(InputError, match="record: it is list, of which record 2 is ndarray"):
        diagnose([record, u], "dea_membrane")
