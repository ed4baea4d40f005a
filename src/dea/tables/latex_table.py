"""Tables for LaTeX with booktabs, terms and powers of ten as mathematics."""

import re

import pandas as pd

from dea.number_format import DASH
from dea.terms import Term, is_term

_SCIENTIFIC = re.compile(r"(< )?(-?[\d.]+)e([+-]\d+)")


def latex(shown: pd.DataFrame) -> str:
    """Return the LaTeX of a table of text, its first column and terms to the left."""
    plain = shown.rename(columns=_latex_text).map(_latex_text)
    columns = "".join(
        "l" if place == 0 or name == "term" else "r" for place, name in enumerate(shown.columns)
    )
    return str(plain.to_latex(index=False, escape=False, column_format=columns))


def _latex_text(text: str) -> str:
    if is_term(text):
        return Term.parse(text).mathematics()
    if scientific := _SCIENTIFIC.fullmatch(text):
        below, factor, power = scientific.groups(default="")
        return rf"${below}{factor} \times 10^{{{int(power)}}}$"
    if "±" in text or text.startswith("-"):
        return "$" + text.replace("±", r"\pm").replace(" %", r"\,\%") + "$"
    for plain, command in (
        (DASH, "--"),
        ("%", r"\%"),
        ("_", r"\_"),
        ("^2", r"\textsuperscript{2}"),
    ):
        text = text.replace(plain, command)
    return text
