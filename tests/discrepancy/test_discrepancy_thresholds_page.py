"""The page of the documentation on the thresholds has the values that a diagnosis uses."""

from pathlib import Path

from dea.discrepancy.thresholds_page import page

ROOT = Path(__file__).parents[2]


def test_the_page_of_the_documentation_is_up_to_date():
    assert (ROOT / "docs/method/thresholds.md").read_text() == page(), "run `make thresholds`"
