"""Figures and tables of a campaign, small and large."""

import pandas as pd
import pytest
from made_trials import FAMILY, campaign

from dea import store, trials
from dea.stages.figures import figures
from dea.stages.tables import tables

FIGURES = ["trials_confusion", "trials_risk_coverage", "trials_strength", "trials_gap"]
TABLES = ["trials", "trials_effects", "trials_forms"]


@pytest.fixture(params=[1, 60], ids=lambda n: f"{n} trials")
def scores(request, tmp_path):
    path = tmp_path / "tuning" / "scores.nc"
    store.write(trials.scores(*campaign(request.param), FAMILY), path, title="made up")
    return path


@pytest.mark.slow
def test_the_figures_are_drawn_the_same_each_time(scores, tmp_path):
    options = [(name, {"clean": 1.15} if name == "trials_gap" else {}) for name in FIGURES]
    settings = {"resolution": 50, "figures": options}
    drawn = []
    for folder in (tmp_path / "a", tmp_path / "b"):
        paths = {kind: [folder / f"{name}.{kind}" for name in FIGURES] for kind in ("png", "pdf")}
        figures(settings, sources=[scores], **paths)
        drawn.append([file.read_bytes() for kind in paths.values() for file in kind])
    assert drawn[0] == drawn[1]
    assert len(set(drawn[0])) == 2 * len(FIGURES)


def test_the_tables_hold_the_scores(scores, tmp_path):
    paths = {
        kind: [tmp_path / f"{name}.{kind}" for name in TABLES] for kind in ("csv", "md", "tex")
    }
    tables({"tables": TABLES}, sources=[scores], **paths)
    assert all(file.read_text().strip() for kind in paths.values() for file in kind)
    rates, effects, forms = map(pd.read_csv, paths["csv"])
    dataset = store.read(scores)
    assert list(rates["rate_trials"]) == dataset["rate_trials"].values.tolist()
    assert effects["trials"].sum() == dataset.sizes["trial"]
    assert forms["trials"].sum() == int(dataset["form_outcomes"].sum())
