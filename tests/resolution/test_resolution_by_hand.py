"""Designed records that are made by hand."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_devices import LIMITS

from dea.configuration.case import check_case
from dea.configuration.files import read_yaml
from dea.configuration.study import check_study
from dea.resolution import Design, by_hand, experiment_page
from dea.resolution.by_hand import plays
from dea.resolution.excitation import express, genes


@pytest.mark.parametrize(
    "units", [("V", "mm"), ("%", "degC"), ("1", "Ω"), ("no", "m/s^2"), ('"', ": {°}")]
)
@pytest.mark.parametrize("others", [False, True])
def test_what_the_page_says_to_add_makes_a_case_that_is_read(tmp_path, units, others):
    design = Design(np.sin(np.arange(50) / 10), -5.0, ("a", "b"), 3.0, "free")
    page = experiment_page("rig", "resolve_2", design, LIMITS, {"a": 1.0}, units, others=others)
    entry = re.search(r"```yaml\n(.*?)```", page, re.DOTALL)[1]
    file = tmp_path / "rig.yaml"
    columns = "input: {column: a, units: V}, output: {column: b, units: V}"
    record = f"{{file: a.csv, sampling_interval: 0.02, {columns}}}\n"
    before = f"records:\n  another: {record}" if others else ""
    file.write_text(f"title: A rig\nrecord: {record}{before}{entry}")
    config = Path(__file__).parents[2] / "config/config.yaml"
    study = check_study(read_yaml(config, what="", example=""))
    case = check_case(read_yaml(file, what="", example=""), study)
    found = case.records["resolve_2"]
    assert (found.input.units, found.output.units) == units
    assert ("another" in case.records) is others


@pytest.mark.parametrize(
    ("change", "taken"),
    [
        (lambda u: np.roll(u, 1), True),
        (lambda u: u + 0.02 * np.random.default_rng(0).standard_normal(u.size), True),
        (lambda u: u[:290], True),
        (lambda u: u[:200], False),
        (lambda u: -u, False),
        (lambda u: u + 0.5, False),
    ],
)
def test_an_input_played_by_hand_may_be_a_little_off(change, taken):
    u = np.sin(np.arange(300) / 10)
    assert plays(change(u), u) is taken


@pytest.mark.parametrize("shift", [-2, -1, 1, 2])
def test_an_input_may_be_a_sample_late_however_fast_it_moves(shift):
    """The sines of a design reach an eighth of the sampling rate."""
    rng = np.random.default_rng(0)
    wide = replace(LIMITS, rate=1e9)
    for _ in range(20):
        u = express(rng.random(genes()), 20.0, wide)
        played = np.roll(u, shift)
        assert plays(played, u)
        assert not plays(express(rng.random(genes()), 20.0, wide), u)


@pytest.mark.parametrize(
    ("described", "remedy"),
    [
        ({}, "`rows: [50, 350]`"),
        ({"rows": (200, 900)}, "`rows: [250, 550]`"),
        ({"rows": (-900, -1)}, "`rows`, the numbers of its rows from 1 to 7 s"),
        ({"resample": 0.02}, "`rows`, the numbers of its rows from 1 to 7 s"),
    ],
)
def test_rows_that_begin_with_the_excitation_are_those_of_the_file(described, remedy):
    """Samples are counted after `rows` and `resample`, rows before these."""
    asked = np.sin(2 * np.pi * (np.arange(300) / 150) ** 2)
    u = np.concatenate([np.full(50, asked[0]), asked, np.zeros(9)])
    found = SimpleNamespace(u=u, y=np.zeros(u.size), sampling_rate=50.0)
    told = SimpleNamespace(**({"rows": None, "resample": None} | described))
    assert by_hand._mistake(found, asked, 50.0, told)[1].endswith(remedy)
