import pytest

from dea.resolution import design


@pytest.fixture
def few_excitations(monkeypatch):
    """Try few excitations for each design: some of the first already tell a lag from a delay."""
    monkeypatch.setattr(design, "_MOST_TRIED", design._FEWEST)
