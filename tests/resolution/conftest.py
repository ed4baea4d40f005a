import pytest


@pytest.fixture
def few_excitations(monkeypatch):
    """Try few excitations for each design: some of the first already tell a lag from a delay."""
    monkeypatch.setattr("dea.resolution.design._MOST_TRIED", 32)
