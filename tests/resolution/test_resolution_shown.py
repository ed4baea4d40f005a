"""What the figure plots and the table lists of a resolution."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg

from dea.figures.resolution import resolution as figure
from dea.store import CONTRACTS
from dea.tables.resolution import resolution as table


@pytest.fixture
def found(tmp_path):
    def over(dims, values, units="1"):
        return dims, np.array(values), {"units": units, "long_name": "a quantity"}

    dataset = xr.Dataset(
        {
            "probability": over(
                ("round", "hypothesis"),
                [[0.4, 0.5, 0.1, np.nan], [0.9, 0.0005, 0.0495, 0.05], [1.0, 1e-9, 1e-12, 1e-8]],
            ),
            "rejected": over(
                ("round", "hypothesis"), [[0, 0, 0, 0], [0, 1, 0, 0], [0, 1, 1, 1]]
            ),
            "driven": over("round", [0.0, 30.0, 90.0], "s"),
            "status": over("round", ["ambiguous", "named in part", "named"]),
            "names": over("round", ["a or b", "a", "a"]),
            "error_before": over("round", [0.02, 0.03, 0.03], "mm"),
            "error_after": over("round", [0.01, 0.002, 0.002], "mm"),
            "form": over("round", ["", "free", "staircase"]),
            "closest": over("round", ["", "a/b", "a/c"]),
            "distance": over("round", [np.nan, 12.0, 9.0]),
        },
        coords={"round": [0, 1, 2], "hypothesis": ["viscoelastic_creep", "b", "another", "c"]},
        attrs={"outcome": "decided", "level": 0.01, "contract": "resolution"},
    )  # fmt: skip
    CONTRACTS["resolution"].check(dataset, tmp_path)
    return dataset


def test_probabilities_are_drawn_over_the_seconds_driven_and_rejections_crossed(found):
    (ax,) = figure(found, "dea1").axes
    lines = {line.get_label(): line for line in ax.lines if line.get_linestyle() != "None"}
    np.testing.assert_array_equal(lines["viscoelastic creep"].get_xdata(), [0, 30, 90])
    np.testing.assert_allclose(lines["b"].get_ydata(), [0.5, 0.0005, 1e-4])
    crosses = [line for line in ax.lines if line.get_marker() == "x"]
    drawn = {tuple(line.get_xdata()) for line in crosses}
    assert {(30, 90), (90,), ()} == drawn
    assert ax.get_yscale() == "logit"


def test_a_hypothesis_of_many_effects_fits_the_page(found):
    many = "rate_independent_hysteresis+periodic_disturbance+viscoelastic_creep+strain_stiffening"
    names = found["hypothesis"].copy(data=[many, "b", "another", "c"])
    page = figure(found.assign_coords(hypothesis=names), "dea1")
    FigureCanvasAgg(page)
    page.draw_without_rendering()
    texts = page.legends[0].get_texts()
    said = [text.get_text() for text in texts]
    assert many.replace("_", " ").replace("+", " + ") in [text.replace("\n", " ") for text in said]
    assert {"b", "another", "rejected"} <= set(said)
    for text in texts:
        box = text.get_window_extent()
        assert page.bbox.x0 <= box.x0 < box.x1 <= page.bbox.x1, text
        assert page.bbox.y0 <= box.y0


def test_a_row_for_each_round_says_what_is_left(found):
    rows = table({"dea1": found, "dea2": found.isel(round=[0])}).exact
    assert list(rows["system"]) == ["dea1", "dea1", "dea1", "dea2"]
    assert list(rows["driven (s)"]) == [0.0, 30.0, 90.0, 0.0]
    assert list(rows["hypotheses left"]) == [3, 3, 1, 3]
    assert list(rows["likeliest"][:2]) == ["b", "viscoelastic_creep"]
    assert list(rows["outcome"]) == ["", "", "decided", "decided"]
    assert rows["error after (mm)"][2] == 0.002
