"""The page of a case: one file of HTML that holds its pictures."""

import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape

from dea.case_page.findings import Findings, Score, percentage
from dea.number_format import number

# The pictures that belong to a section, by the beginning of their names.
_CAPTIONS = {
    "fig2": "Orders compared on independent data (A, B), forecast against measured output (C), and"
    " free-run simulation of each window: parameters of a forecast are estimated before the window,"
    " fitted ones from the window itself, both so that the free run's error is least; those fitted"
    " one step ahead from the window by least squares on the one-step prediction.",
    "residual_tests": "What remains of the output: correlations of the residual with its past, and"
    " below, made white, with the input. With a smooth input neighbouring lags leave the band"
    " together; p, of all lags of a panel together, says whether there is any.",
    "tracked_parameters": "Above: what free-run simulation of the whole record leaves unexplained,"
    " with fixed and with tracked parameters. Below: each parameter over time{bands}. Those of"
    " neighbouring lags are strongly correlated: compare the frequency responses instead.{unsure}",
    "fig3": "Gain of the frequency response over time, and at three times{bands}.{unsure}",
    "fig4_h2": "Second-order response: which output two input frequencies produce together.",
    "discrepancy": "A: measured less simulated output, of the simulation alone and with what is"
    " named; shaded, the certified samples, which no fit has seen. B: both where they disagree"
    " most. C: size of the residual along the quantity that it depends on most, before and after,"
    " and what chance reaches. D: error on parts of the record left out, with one effect after the"
    " other, down to the noise floor; what the simulation alone leaves above noise is the gap. E:"
    " the law that is named, with its 95 % band. F: how sure each effect is part of the answer, and"
    " how much of the gap it removes. docs/discrepancy.md has the terms.",
}
_UNSURE = " Without bands this does not tell drift from error of estimation."
_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem;
  color: #1a1a1a; background: #fff; }
h1, h2 { line-height: 1.2; } h2 { margin-top: 2.5rem; }
.equation { background: #f4f4f4; padding: .5rem 1rem; overflow-x: auto; }
table { border-collapse: collapse; } th, td { padding: .3rem .9rem .3rem 0; text-align: left; }
td + td { text-align: right; } tbody tr:first-child { font-weight: 600; }
tr { border-bottom: 1px solid #ddd; } img { max-width: 100%; } figcaption { color: #555; }
.verdict { border-left: 4px solid #0072b2; padding-left: 1rem; }
"""


def page(findings: Findings, pictures: Mapping[str, bytes]) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    pictures
        PNG files by their names: ``fig2``, ``residual_tests``, ``tracked_parameters``, ``fig3``,
        ``fig4_h2``, ``discrepancy``; those that are there are shown.
    """
    missing = findings.missing_effect
    parts = [
        f"<h1>{escape(findings.title)}</h1>",
        f"<p>{escape(findings.record)}</p>",
        f'<div class="equation">{findings.equation_in_html}</div>',
        *_section(
            "What the simulation is missing", missing, pictures, _captions(findings, "discrepancy")
        ),
        *_paragraph(findings.not_offered),
        *_scores(findings),
        *_section("Windows", "", pictures, _captions(findings, "fig2")),
        *_section("Stability", findings.stability, {}, {}),
        *_section("Residuals", findings.residuals, pictures, _captions(findings, "residual_tests")),
        *_section(
            "Frequency responses",
            _responses(findings),
            pictures,
            _captions(findings, "fig3", "fig4_h2"),
        ),
        *_section("Change over time", "", pictures, _captions(findings, "tracked_parameters")),
        f"<p>Files: <code>results/{escape(findings.name)}/</code>; settings:"
        f" <code>config/cases/{escape(findings.name)}.yaml</code>.</p>",
    ]
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(findings.title)}</title><style>{_STYLE}</style></head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )


def _responses(findings: Findings) -> str:
    withheld = findings.responses_withheld
    return f"No bands are given: {withheld}." if withheld else ""


def _captions(findings: Findings, *names: str) -> dict[str, str]:
    """Return the captions of pictures; bands are told of where they are given."""
    withheld = bool(findings.responses_withheld)
    said = {"bands": "" if withheld else " with 95 % bands", "unsure": _UNSURE if withheld else ""}
    return {name: _CAPTIONS[name].format(**said) for name in names}


def _section(
    heading: str, text: str, pictures: Mapping[str, bytes], captions: Mapping[str, str]
) -> list[str]:
    """Return a section with its text and those of its pictures that there are."""
    shown = [name for name in captions if name in pictures]
    if not text and not shown:
        return []
    told = _paragraph(text, ' class="verdict"')
    widest = max(map(_width, pictures.values()), default=1)
    figures = (_figure(pictures[n], captions[n], _width(pictures[n]) / widest) for n in shown)
    return [f"<h2>{heading}</h2>", *told, *figures]


def _paragraph(text: str, attributes: str = "") -> list[str]:
    """Return a text as a paragraph, what it quotes as code; none where it is empty."""
    marked = re.sub("`([^`]+)`", r"<code>\1</code>", escape(text))
    return [f"<p{attributes}>{marked}</p>"] if text else []


def _width(png: bytes) -> int:
    """Return the pixels across a picture, from the first chunk of its file."""
    return int.from_bytes(png[16:20])


def _figure(png: bytes, caption: str, share: float) -> str:
    """Show a picture on this share of the page's width, so that all have letters of one size."""
    data = b64encode(png).decode("ascii")
    text = escape(caption)
    return (
        f'<figure><img style="width: {share:.0%}" alt="{text}" src="data:image/png;base64,{data}">'
        f"<figcaption>{text}</figcaption></figure>"
    )


def _scores(findings: Findings) -> list[str]:
    tables = []
    for part, scores in findings.scores().items():
        tables += [f"<p>Free run on <code>{escape(part)}</code>:</p>", _table(scores, findings)]
    return ["<h2>On unseen data</h2>", *tables] if tables else []


def _table(scores: Sequence[Score], findings: Findings) -> str:
    units = escape(findings.signals.y_units)
    rows = "".join(
        f"<tr><td>{escape(score.name)}</td><td>{percentage(score.nmse)}</td>"
        f"<td>{number(score.rmse)}</td></tr>"
        for score in scores
    )
    return (
        "<table><thead><tr><th></th><th>variance explained</th>"
        f"<th>rmse ({units})</th></tr></thead><tbody>{rows}</tbody></table>"
    )
