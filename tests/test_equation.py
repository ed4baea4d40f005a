import re

import numpy as np
import pytest

from dea.equation import equation_html, equation_latex, equation_text, scaling_text
from dea.terms import Term

TERMS = [Term.parse(text) for text in ("1", "y(t-1)", "y(t-2)u(t)", "u(t-1)^3")]
PARAMETERS = [0.123456, -1.5, 2.00004e-7, -3.0]


def test_the_text_has_the_digits_asked_for_and_is_the_model_again():
    text = equation_text(TERMS, PARAMETERS)
    assert text == "y(t) = 0.1235 - 1.500 y(t-1) + 2.000e-07 y(t-2)u(t) - 3.000 u(t-1)^3"
    signs = re.findall(r"([-+]?) ?(\d[\d.e-]*)(?: ([yu]\S*))?", text.split("=")[1])
    read = {name or "1": float(sign + value) for sign, value, name in signs}
    for term, parameter in zip(TERMS, PARAMETERS, strict=True):
        assert read[str(term)] == pytest.approx(parameter, rel=1e-3)


def test_latex_can_be_set():
    from matplotlib.mathtext import MathTextParser

    text = equation_latex(TERMS, PARAMETERS)
    assert r"2.000\times 10^{-7}" in text
    MathTextParser("path").parse(f"${text}$")


def test_html_names_the_scaling_where_there_is_one():
    plain = {"u_offset": 0.0, "u_scale": 1.0, "y_offset": 0.0, "y_scale": 1.0}
    assert equation_html(TERMS, PARAMETERS, plain).count("<p>") == 1
    named = [("drive", "V")]
    scaled = equation_html(TERMS, PARAMETERS, plain | {"u_offset": np.pi}, named, "mm")
    assert "<i>u</i> = (input - 3.142 V) / 1.000 V" in scaled
    assert "<i>u</i>(<i>t</i>−1)<sup>3</sup>" in scaled


def test_html_names_several_inputs_even_where_nothing_is_scaled():
    terms, inputs = [Term.parse("u1(t-1)u2(t)^2")], [("left", "V"), ("right <b>", "1")]
    plain = {"u_offset": 0.0, "u_scale": 1.0, "y_offset": 0.0, "y_scale": 1.0}
    shown = equation_html(terms, [0.5], plain, inputs)
    assert "<i>u</i><sub>1</sub>(<i>t</i>−1)<i>u</i><sub>2</sub>(<i>t</i>)<sup>2</sup>" in shown
    assert "<i>u</i><sub>1</sub> = (left + 0.000 V) / 1.000 V" in shown
    assert "<i>u</i><sub>2</sub> = (right &lt;b&gt; + 0.000) / 1.000" in shown
    assert "<i>y</i> = (" not in shown


def test_the_scaling_as_text_is_empty_where_there_is_none():
    plain = {"u_offset": 0.0, "u_scale": 1.0, "y_offset": 0.0, "y_scale": 1.0}
    assert scaling_text(plain, [("drive", "V")], "mm") == ""
    scaled = scaling_text(plain | {"y_offset": -1.0, "y_scale": 2.5}, [("drive", "V")], "mm")
    assert scaled == "y = (output + 1.000 mm) / 2.500 mm"
