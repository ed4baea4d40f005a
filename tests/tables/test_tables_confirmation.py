"""The table of confirmations holds what its datasets do."""

import numpy as np
import pytest

import made_datasets as made
from dea.number_format import DASH
from dea.tables.confirmation import confirmation


def test_the_confirmation_table_counts_the_lines_inside(each, names, saved):
    found = each(made.confirmation)
    csv, md, tex = saved(confirmation(found))
    assert len(csv) == 3 * len(names) == len(md.splitlines()) - 4
    first = csv.iloc[0]
    assert first["time (min)"] == 5.0
    # Of the lines at 0.05, 0.5 and 1 Hz, the one at 0.5 Hz is outside.
    assert (first["lines in band"], first["lines"]) == (2, 3)
    assert first["largest difference of gain (%)"] == -10.0
    assert (first["even lines in band"], first["even lines"]) == (1, 2)
    assert md.splitlines()[2].split("|")[3:5] == [" 3       ", " 2               "]
    assert first["gain at 5 Hz (%)"] == -50.0
    heads = [cell.strip() for cell in md.splitlines()[0].split("|")]
    assert {"error of extrapolated gain at 5 Hz (%)", "the model's own band"} <= set(heads)
    assert "even lines, measured over predicted, median" in heads
    assert "in the joint band" in md.splitlines()[2]
    assert tex.count("%") == tex.count(r"\%") > 0  # else a comment to LaTeX


def test_even_distortion_is_told_from_noise_and_from_odd_distortion(each, saved):
    """Even lines in the band hold 5 and 13, noise of them 3 and 5, and the odd one a thousand."""
    found = each(made.confirmation)
    for one in found.values():
        one["output_level"][:] = np.array([5.0, 1000.0, 13.0, 1000.0]) * 1e-5
        one["output_noise"][:] = np.array([3.0, 1.0, 5.0, 1.0]) * 1e-5
        one.coords["detection_frequency"] = [0.1, 0.15, 0.2, 1.1]
    csv, md, _ = saved(confirmation(found))
    # 4e-5 and 12e-5 are left, at 0.01 of the excited lines.
    np.testing.assert_allclose(csv["even distortion (%)"], 0.8)
    assert "even distortion, median (%)" in md
    for one in found.values():
        one["odd"][:] = 1
    assert saved(confirmation(found))[0]["even distortion (%)"].isna().all()


def test_even_lines_are_counted_where_they_are_judged(each, saved):
    found = each(made.confirmation)
    for one in found.values():
        one["even_judged"][:] = [0, 0, 1]
    csv, _, _ = saved(confirmation(found))
    assert (csv["even lines"] == 1).all()
    assert (csv["even lines in band"] == 0).all()


def test_the_reason_why_a_band_is_withheld_is_said(each, saved):
    found = each(made.confirmation)
    found["dea1"].attrs["model_band_withheld"] = "the residual is not white"
    csv, md, tex = saved(confirmation(found))
    own = csv.set_index("actuator")["band of the model"]
    assert (own.loc["dea1"] == "withheld: the residual is not white").all()
    assert (own.drop("dea1") == "in it").all()
    assert "withheld: the residual is not white" in md
    assert "withheld: the residual is not white" in tex


@pytest.mark.parametrize(("lines_in_band", "at_2_hz"), [(3, -50.0), (4, np.nan), (5, np.nan)])
def test_an_extrapolated_gain_is_of_a_line_near_by_outside_the_band(
    lines_in_band, at_2_hz, each, saved
):
    found = {
        name: one.assign_coords(frequency=[0.05, 0.5, 1.0, 1.9, 3.0]).assign(
            in_band=("frequency", np.arange(5) < lines_in_band)
        )
        for name, one in each(made.confirmation).items()
    }
    csv, md, _ = saved(confirmation(found))
    np.testing.assert_array_equal(csv["gain at 2 Hz (%)"], at_2_hz)
    assert csv[["gain at 5 Hz (%)", "gain at 10 Hz (%)"]].isna().all(axis=None)
    assert [cell.strip() for cell in md.splitlines()[2].split("|")[-3:-1]] == [DASH, DASH]
