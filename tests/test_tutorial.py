"""The tutorial runs, and finds what it says."""

import pytest

from notebooks import run

pytestmark = pytest.mark.slow


def test_the_tutorial_names_the_effect_that_it_hid(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")
    names = run("tutorial")
    assert names["score"] > 0.95
    assert names["diagnosis"].verdict.status == "named"
    assert names["diagnosis"].verdict.names == ("dead_zone",)
