"""What a user's simulation imports and opens is kept with the job that runs it."""

import json
import sys
from pathlib import Path

import pytest

from dea import provenance
from dea.errors import InputError
from dea.simulation import load_simulation
from dea.simulation.files_read import files_read
from user_simulation import write_simulation

NEEDS = """
import sys
from pathlib import Path
sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, {elsewhere!r})
import colorsys
import rates_of_mine
import shapes_elsewhere
TABLE = (Path(__file__).parent / "table.csv").read_text()
(Path(__file__).parent / "written.txt").write_text("as it was loaded")
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project whose simulation needs a module, a table, and a module from elsewhere."""
    here, elsewhere = tmp_path / "project", tmp_path / "elsewhere"
    (here / "mine").mkdir(parents=True)
    elsewhere.mkdir()
    monkeypatch.chdir(here)
    monkeypatch.setattr(sys, "path", list(sys.path))
    (here / "mine/rates_of_mine.py").write_text("RATE = 2.0\n")
    (here / "mine/table.csv").write_text("1,2\n")
    (elsewhere / "shapes_elsewhere.py").write_text("SHAPE = 1.0\n")
    file = write_simulation(Path("mine/simulation.py"))
    file.write_text(NEEDS.format(elsewhere=str(elsewhere)) + file.read_text())
    yield elsewhere
    for name in ("rates_of_mine", "shapes_elsewhere"):
        sys.modules.pop(name, None)


def test_modules_and_files_of_the_user_alone_are_seen(project):
    with files_read() as read:
        load_simulation("mine/simulation.py")
        Path("mine/table.csv").read_text()
    Path("mine/later.csv").write_text("3,4\n")
    Path("mine/later.csv").read_text()
    helpers = {Path("mine/rates_of_mine.py"), Path("mine/table.csv")}
    assert read - {Path("mine/simulation.py")} == {*helpers, project / "shapes_elsewhere.py"}


def test_a_helper_is_seen_and_read_anew_whenever_its_simulation_is_loaded(project):
    with files_read() as first:
        load_simulation("mine/simulation.py")
    Path("mine/rates_of_mine.py").write_text("RATE = 2.0\nEDITED = True\n")
    with files_read() as again:
        load_simulation("mine/simulation.py")
    assert again == first
    assert sys.modules["rates_of_mine"].EDITED


def test_a_simulation_whose_classes_look_at_their_module_is_loaded_again(project):
    file = Path("mine/classes.py")
    write_simulation(file)
    header = "from __future__ import annotations\nfrom dataclasses import dataclass\n\n\n"
    header += "@dataclass\nclass Own:\n    rate: float = 2.0\n\n\n"
    file.write_text(header + file.read_text())
    with files_read():
        load_simulation(file)
    with files_read():
        load_simulation(file)
    load_simulation(file)


def test_a_job_keeps_what_its_simulation_reads(project, monkeypatch):
    monkeypatch.setenv(provenance.JOB, "results/a/log/diagnose.log")
    monkeypatch.setenv(provenance.RULE, "diagnose")
    monkeypatch.setenv(provenance.CODE, "")
    product, own = Path("results/a/verdict.json"), Path("mine/simulation.py")
    with provenance.job(["x", str(product)], {}, inputs=[own], outputs=[product]):
        load_simulation(own)
        product.write_text("{}")
    said = json.loads(provenance.description_of(product).read_text())
    assert said["run"]["read"] == {
        str(file): provenance.digest(Path(file))
        for file in ("mine/rates_of_mine.py", "mine/table.csv", project / "shapes_elsewhere.py")
    }
    provenance.check(product, provenance.digest(product))
    Path("mine/table.csv").write_text("1,3\n")
    with pytest.raises(InputError, match=r"it was made from another mine/table\.csv"):
        provenance.check(product, provenance.digest(product))


def test_what_is_read_after_a_block_within_counts_for_the_block_around(project):
    Path("later.csv").write_text("1\n")
    with files_read() as around:
        with files_read() as within:
            Path("mine/table.csv").read_text()
        Path("later.csv").read_text()
    assert within == {Path("mine/table.csv")}
    assert around == {Path("mine/table.csv"), Path("later.csv")}
