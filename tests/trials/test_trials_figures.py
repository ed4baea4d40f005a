"""Figures and tables of a campaign, small and large."""

from importlib import import_module

import pandas as pd
import pytest
from made_trials import FAMILY, campaign

from dea import store, trials

FIGURES = ["trials_confusion", "trials_risk_coverage", "trials_strength", "trials_gap"]
TABLES = ["table_trials", "table_trials_effects"]


@pytest.fixture(params=[1, 60], ids=lambda n: f"{n} trials")
def scores(request, tmp_path):
    path = tmp_path / "scores.nc"
    store.write(trials.scores(*campaign(request.param), FAMILY), path, title="made up")
    return path


@pytest.mark.parametrize("stage", FIGURES)
def test_a_stage_draws_its_figure_the_same_each_time(stage, scores, tmp_path):
    run = getattr(import_module(f"dea.stages.{stage}"), stage)
    files = [tmp_path / f"{name}.{kind}" for name in "ab" for kind in ("png", "pdf")]
    for png, pdf in (files[:2], files[2:]):
        run({"figures": {"resolution": 50}}, scores=scores, png=png, pdf=pdf)
    assert files[0].read_bytes().startswith(b"\x89PNG")
    assert files[0].read_bytes() == files[2].read_bytes()
    assert files[1].read_bytes() == files[3].read_bytes()


@pytest.mark.parametrize("stage", TABLES)
def test_a_stage_prints_its_table_three_ways(stage, scores, tmp_path):
    outputs = {kind: tmp_path / f"t.{kind}" for kind in ("csv", "md", "tex")}
    getattr(import_module(f"dea.stages.{stage}"), stage)({}, scores=scores, **outputs)
    assert all(path.read_text().strip() for path in outputs.values())
    exact = pd.read_csv(outputs["csv"])
    dataset = store.read(scores)
    if stage == "table_trials":
        assert list(exact["rate_trials"]) == dataset["rate_trials"].values.tolist()
    else:
        assert exact["trials"].sum() == dataset.sizes["trial"]
