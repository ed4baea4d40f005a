"""The stages of figures and tables, and that their lists, modules and captions belong together."""

import json
from pathlib import Path

import pytest
import yaml

import made_datasets as made
from dea import store
from dea.errors import InputError
from dea.stages.figures import figures
from dea.stages.tables import tables

ROOT = Path(__file__).parents[2]
KINDS = {"figures": ("png", "pdf"), "tables": ("csv", "md", "tex")}
# Figures or tables of one job, the datasets they read, and of how many actuators.
FIGURES = [
    (["fig1"], ["record"], 1),
    (["fig2", "residual_tests"], ["orders", "validation"], 1),
    (["tracked_parameters"], ["record", "track"], 1),
    (["fig3", "fig3_phase", "fig4_h2", "fig4_h2_phase", "fig4_h3"], ["record", "gfrf"], 2),
    (["link"], ["link"], 2),
    (["recovery"], ["recovery"], 1),
]
TABLES = [
    (["table1"], ["model", "validation", "track", "common_model"], 2),
    (["validation", "tracking"], ["model", "validation", "track"], 2),
    (["recovery"], ["recovery"], 1),
]


@pytest.fixture
def sources(tmp_path):
    """Write datasets of so many actuators."""

    def write(datasets, count):
        files = []
        for name in datasets:
            if name == "common_model":
                files.append(tmp_path / "common_model.nc")
                systems = [f"dea{seed}" for seed in range(1, count + 1)]
                store.write(made.common_model(systems), files[-1], title=name)
                continue
            for seed in range(1, count + 1):
                files.append(tmp_path / f"dea{seed}" / f"{name}.nc")
                store.write(getattr(made, name)(seed), files[-1], title=name)
        return files

    return write


def listed(room):
    return yaml.safe_load((ROOT / "workflow" / f"{room}.yaml").read_text())


def outputs(room, names, folder):
    return {kind: [folder / f"{name}.{kind}" for name in names] for kind in KINDS[room]}


@pytest.mark.slow
@pytest.mark.parametrize(("names", "datasets", "count"), FIGURES)
def test_the_stage_draws_each_figure_as_png_and_pdf(names, datasets, count, sources, tmp_path):
    paths = outputs("figures", names, tmp_path / "figures")
    options = [(name, {"zoom": [100, 130]} if name == "fig1" else {}) for name in names]
    settings = {"resolution": 50, "figures": options}
    figures(settings, sources=sources(datasets, count), **paths)
    assert all(file.read_bytes().startswith(b"\x89PNG") for file in paths["png"])
    assert all(file.read_bytes().startswith(b"%PDF") for file in paths["pdf"])
    assert len({file.read_bytes() for file in paths["png"]}) == len(names)
    assert len(list((tmp_path / "figures").iterdir())) == 2 * len(names)


def test_each_figure_is_at_its_path_by_settings_as_a_job_keeps_them(sources, tmp_path):
    names = ["residual_tests", "fig2"]
    files = sources(["orders", "validation"], 1)

    def drawn(folder, names):
        paths = outputs("figures", names, tmp_path / folder)
        settings = {"resolution": 50, "figures": [(name, {}) for name in names]}
        kept = json.loads(json.dumps(settings, sort_keys=True))
        figures(kept, sources=files, **paths)
        return [file.read_bytes() for kind in zip(*paths.values(), strict=True) for file in kind]

    alone = [each for name in names for each in drawn(name, [name])]
    assert drawn("together", names) == alone


@pytest.mark.parametrize(("names", "datasets", "count"), TABLES)
def test_the_stage_writes_each_table_three_ways(names, datasets, count, sources, tmp_path):
    paths = outputs("tables", names, tmp_path / "tables")
    tables({"tables": names}, sources=sources(datasets, count), **paths)
    texts = [file.read_text() for kind in paths.values() for file in kind]
    assert len(set(texts)) == 3 * len(names)
    if count == 2:
        assert all("dea2" in text for text in texts)


def test_a_broken_dataset_stops_the_stage_before_anything_is_written(sources, tmp_path):
    files = [*sources(["validation"], 1), tmp_path / "dea1" / "orders.nc"]
    paths = outputs("figures", ["fig2"], tmp_path / "figures")
    with pytest.raises(InputError, match=r"orders\.nc"):
        figures({"resolution": 50, "figures": [("fig2", {})]}, sources=files, **paths)
    assert not (tmp_path / "figures").exists()


@pytest.mark.parametrize("room", KINDS)
def test_every_entry_of_a_list_has_a_caption_and_every_caption_an_entry(room):
    captions = {path.stem for path in (ROOT / "workflow" / "report" / room).iterdir()}
    assert captions == set(listed(room))


@pytest.mark.parametrize(("room", "entry"), [("figures", "def draw("), ("tables", "def tabulate(")])
def test_every_entry_of_a_list_has_a_module_and_every_module_an_entry(room, entry):
    modules = {
        path.stem
        for path in (ROOT / "src" / "dea" / room).glob("*.py")
        if entry in path.read_text()
    }
    assert modules == set(listed(room))
