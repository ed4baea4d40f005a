"""A model that never comes to rest has no frequency response; its figures say so and are drawn."""

import numpy as np
import pytest

import made_datasets as made
from dea.figures.fig3 import fig3
from dea.figures.fig3_phase import fig3_phase
from dea.figures.fig4_h2 import fig4_h2
from dea.figures.fig4_h2_phase import fig4_h2_phase
from dea.figures.fig4_h3 import fig4_h3
from dea.figures.frequency_maps import magnitude_scale


def restless():
    response = made.gfrf(1)
    missing = {
        name: response[name].copy(data=np.full(response[name].shape, np.nan))
        for name in ("H1", "H2", "H3")
    }
    return response.assign(missing)


@pytest.mark.parametrize(
    "draw",
    [
        lambda response: fig3({"mine": made.record(1)}, {"mine": response}),
        lambda response: fig3_phase({"mine": made.record(1)}, {"mine": response}),
        lambda response: fig4_h2({"mine": response}),
        lambda response: fig4_h2_phase({"mine": made.record(1)}, {"mine": response}),
        lambda response: fig4_h3({"mine": response}),
    ],
)
def test_it_is_drawn_and_explained(draw):
    figure = draw(restless())
    legend = [text.get_text() for each in figure.legends for text in each.get_texts()]
    assert "the model of that time has no steady state" in legend


def test_the_scale_of_magnitudes_spans_the_finite_positive_ones():
    norm = magnitude_scale(np.array([np.nan, 0.0, 2.0, 3.0]))
    assert (norm.vmin, norm.vmax) == (2.0, 3.0)
