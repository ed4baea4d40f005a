"""The page of the documentation on the laws, which keeps every prior, bound and start."""

from dataclasses import asdict
from itertools import combinations
from pathlib import Path

from dea.simulation.page import REFERENCE, page

ROOT = Path(__file__).parents[2]


def test_the_page_of_the_documentation_is_up_to_date():
    assert (ROOT / "docs/laws.md").read_text() == page(), "run `make laws`"


def test_no_two_quantities_of_its_record_coincide():
    """Else a law could take one for the other, and the page would be the same."""
    names = [name for name, value in asdict(REFERENCE).items() if isinstance(value, float)]
    sizes = {name: getattr(REFERENCE, name) for name in (*names, "u_span", "y_span", "z_span")}
    equal = [two for two in combinations(sizes, 2) if sizes[two[0]] == sizes[two[1]]]
    assert not equal
