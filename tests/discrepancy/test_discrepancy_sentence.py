"""Clauses of the verdict's sentence."""

import pytest

from dea.discrepancy.evidence.residual_model import ResidualModel
from dea.discrepancy.report.sentence import equation_sentence


@pytest.mark.parametrize(
    ("equation", "explained", "text"),
    [
        ("0", 0.0, ""),
        (
            "0.3 u(t-1)^2",
            0.42,
            " The best equation for the residual: 0.3 u(t-1)^2 (explains 42 %).",
        ),
    ],
)
def test_an_equation_that_explains_nothing_is_left_out(equation, explained, text):
    assert equation_sentence(ResidualModel(0.5, equation, explained)) == text
