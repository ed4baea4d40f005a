"""The findings of a case in a few lines of a terminal."""

from math import isfinite
from textwrap import fill

from dea.case_page.findings import Findings, Score, percentage
from dea.number_format import number

_WIDTH = 100


def summary(findings: Findings, page: str) -> str:
    """Return equation, scores, stability, what the simulation is missing and the page's path."""
    lines = ["", fill(findings.equation, _WIDTH, subsequent_indent="       "), ""]
    if findings.scaling:
        lines += [fill(findings.scaling, _WIDTH), ""]
    units = findings.signals.y_units
    for part, scores in findings.scores().items():
        lines.append(f"free run on unseen data ({part}):")
        width = max(len(score.name) for score in scores)
        lines += [f"  {score.name:{width}}  {_text(score, units)}" for score in scores]
    lines += ["", fill(findings.stability, _WIDTH), fill(findings.residuals, _WIDTH)]
    for text in (findings.missing_effect, findings.not_offered):
        lines += ["", fill(text, _WIDTH)] if text else []
    return "\n".join([*lines, "", page, ""])


def _text(score: Score, units: str) -> str:
    explained = f"{percentage(score.nmse):>9}"
    if not isfinite(score.nmse):
        return explained
    return f"{explained} explained, rmse {number(score.rmse)} {units}"
