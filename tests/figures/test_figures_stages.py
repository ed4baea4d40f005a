"""Stages draw from files; captions belong to figures and figures to captions."""

import re
from importlib import import_module
from pathlib import Path

import made_datasets as made
import pytest

from dea import store
from dea.errors import InputError

ROOT = Path(__file__).parents[2]
SETTINGS = {"system": "dea1", "quantity": "gain", "figures": {"resolution": 50, "zoom": [100, 130]}}
FIGURES = {
    "fig1": ["record"],
    "fig2": ["orders", "validation"],
    "recovery_figure": ["recovery"],
    "residual_tests": ["validation"],
    "tracked_parameters": ["record", "track"],
    "fig3": ["record*", "gfrf*"],
    "fig4_h2": ["gfrf*"],
    "link_quality": ["link*"],
}
TABLES = {
    "table1": ["model*", "validation*"],
    "table_validation": ["validation*"],
    "table_tracking": ["track*"],
}


@pytest.fixture
def inputs(tmp_path):
    """Write what a stage reads, for one actuator or for two."""

    def write(kinds):
        paths = {}
        for kind in kinds:
            name = kind.rstrip("*")
            files = []
            for seed in (1, 2) if kind.endswith("*") else (1,):
                file = tmp_path / f"dea{seed}" / f"{name}.nc"
                store.write(getattr(made, name)(seed), file, title=name)
                files.append(file)
            paths[name] = files if kind.endswith("*") else files[0]
        return paths

    return write


@pytest.mark.parametrize("stage", FIGURES)
def test_a_stage_draws_its_figure_as_png_and_pdf(stage, inputs, tmp_path):
    png, pdf = tmp_path / "figures" / "f.png", tmp_path / "figures" / "f.pdf"
    run = getattr(import_module(f"dea.stages.{stage}"), stage)
    run(SETTINGS, **inputs(FIGURES[stage]), png=png, pdf=pdf)
    assert png.read_bytes().startswith(b"\x89PNG")
    assert pdf.read_bytes().startswith(b"%PDF")
    assert sorted(path.name for path in png.parent.iterdir()) == ["f.pdf", "f.png"]


@pytest.mark.parametrize("stage", TABLES)
def test_a_stage_prints_its_table_three_ways(stage, inputs, tmp_path):
    outputs = {kind: tmp_path / "tables" / f"t.{kind}" for kind in ("csv", "md", "tex")}
    run = getattr(import_module(f"dea.stages.{stage}"), stage)
    run({}, **inputs(TABLES[stage]), **outputs)
    assert all("dea2" in path.read_text() for path in outputs.values())


def test_a_broken_dataset_stops_a_stage_before_anything_is_written(inputs, tmp_path):
    from dea.stages.fig2 import fig2

    paths = inputs(FIGURES["fig2"])
    paths["orders"] = paths["validation"].with_name("missing.nc")
    png = tmp_path / "figures" / "f.png"
    with pytest.raises(InputError, match=r"missing\.nc"):
        fig2(SETTINGS, **paths, png=png, pdf=png.with_suffix(".pdf"))
    assert not png.parent.exists()


def test_every_caption_is_used_and_every_report_has_one():
    used = set()
    for file in (ROOT / "workflow" / "rules").glob("*.smk"):
        text = file.read_text()
        captions = re.findall(r'caption="\.\./report/(\w+\.rst)"', text)
        assert len(captions) == text.count("report("), file
        used |= set(captions)
    assert used == {path.name for path in (ROOT / "workflow" / "report").glob("*.rst")}
