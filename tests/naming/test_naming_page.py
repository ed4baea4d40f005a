"""The page is in step with the methods and with the stored campaign, and its example works."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from made_tasks import posed

from benchmarks.naming.measured import CASES, RECORDS
from benchmarks.naming.methods import methods
from dea.audit.quotations import value

ROOT = Path(__file__).parents[2]
PAGE = Path("docs/naming_benchmark.md")


@pytest.fixture
def page(monkeypatch):
    monkeypatch.chdir(ROOT)
    return PAGE.read_text(encoding="utf-8")


def test_every_method_has_a_line_on_the_page(page):
    described = re.findall(r"^\| (.+?) \|", page.partition("## Measured")[0], re.MULTILINE)
    assert set(described) >= {method.title for method in methods().values()}


def test_no_method_failed_as_the_page_says(page):
    assert "none did, on a trial or on a record" in page
    assert not any(value(f"naming; failed.{name}") for name in methods())


def test_the_stored_tables_have_a_column_for_each_method(page):
    titles = sorted(method.title for method in methods().values())
    for table in ("table", "each", "records"):
        header = value(f"naming; {table};")[0].strip("| ").split(" | ")
        assert sorted(header[1:]) == titles


def test_every_public_record_with_a_simulation_is_asked_or_named_as_left_out(page):
    cases = {file.stem: yaml.safe_load(file.read_text()) for file in CASES.glob("*.yaml")}
    public = {  # a case of the user's own has its record elsewhere
        name: case for name, case in cases.items() if case["record"]["file"].startswith("data/")
    }
    simulated = {name for name, case in public.items() if "simulation" in case}
    asked = {row.strip("| ").split(" ")[0] for row in value("naming; records;")[2:]}
    (left_out,) = re.findall(r"\*\*Records left out\.\*\*.*?\n\n", page, re.DOTALL)
    assert simulated - asked == set(re.findall(r"`(\w+)`", left_out))
    assert set(RECORDS) <= simulated


def test_the_example_of_a_method_answers(page):
    (example,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    defined = {}
    exec(example, defined)
    given = posed(samples=500)
    answer = defined["METHOD"].answer(given.task)
    assert answer.status == "unknown"
    left = given.task.nominal.residual[given.task.problem.seen]
    shift = answer.ahead - given.task.ahead(given.task.nominal)
    np.testing.assert_allclose(shift, left.mean())
