"""Values and ranges of the thresholds are those of the documentation and of the config."""

from dataclasses import fields
from pathlib import Path

import pytest
from annotated_types import Ge

from dea.configuration import discrepancy as configured
from dea.discrepancy.budget import Budget
from dea.discrepancy.rules import Rules
from dea.discrepancy.thresholds_page import page
from dea.errors import InputError

ROOT = Path(__file__).parents[2]


def test_the_page_of_the_documentation_is_up_to_date():
    assert (ROOT / "docs/method/thresholds.md").read_text() == page(), "run `make thresholds`"


@pytest.mark.parametrize(("thresholds", "section"), [(Budget, "Budget"), (Rules, "Rules")])
def test_the_least_value_is_that_of_the_config(thresholds, section):
    allowed = getattr(configured, section).model_fields
    for each in fields(thresholds):
        [least] = [m.ge for m in allowed[each.name].metadata if isinstance(m, Ge)] or [0]
        thresholds(**{each.name: type(each.default)(least or each.default)})
        with pytest.raises(InputError, match=rf"{each.name}: it is"):
            thresholds(**{each.name: type(each.default)(least - 1)})
