"""A designed record for a device that no program drives: what to run, and how to hand it in."""

from collections.abc import Mapping

import numpy as np

from dea.resolution.design import Design
from dea.resolution.excitation import Limits


def excitation_table(u: np.ndarray, sampling_rate: float, units: str) -> str:
    """Return the excitation as CSV with times in s; reading it back gives the same numbers."""
    rows = (f"{k / sampling_rate:.9g},{value!r}" for k, value in enumerate(u.tolist()))
    return "\n".join([f"time (s),input ({units})", *rows]) + "\n"


def experiment_page(
    name: str,
    key: str,
    design: Design,
    limits: Limits,
    probabilities: Mapping[str, float],
    units: tuple[str, str],
) -> str:
    """Return the page, in Markdown, that says how to make the record ``key`` of a case."""
    seconds = design.u.size / limits.sampling_rate
    rate = float(np.abs(np.diff(design.u)).max()) * limits.sampling_rate
    told = "The record of `next_excitation.csv` shows how well the one that is left predicts."
    if design.closest:
        first, second = design.closest
        told = (
            "On the excitation in `next_excitation.csv` the two that are hardest to tell apart,"
            f" {first} and {second}, differ by {design.distance:.3g} standard deviations of the"
            " error."
        )
    left = sorted(probabilities.items(), key=lambda item: -item[1])
    lines = [
        f"# Next experiment: {name}, `{key}`",
        "",
        "How probable each explanation of the device is by the records so far:",
        "",
        "| explanation | probability |",
        "|---|---|",
        *(f"| {each} | {value:.3f} |" for each, value in left),
        "",
        told,
        "",
        "## Run it",
        f"* {seconds:g} s at {limits.sampling_rate:g} Hz, {design.u.size} samples, each held until"
        " the next.",
        f"* Input from {design.u.min():.4g} to {design.u.max():.4g} {units[0]}, changing by up to"
        f" {rate:.4g} {units[0]}/s. Before it, let the device rest at the first value.",
        f"* The output is expected between {limits.output_low:.4g} and {limits.output_high:.4g}"
        f" {units[1]}. Stop where it leaves this range.",
        "* Record input and output as in the first record, at the same rate.",
        "",
        "## Hand it in",
        f"Add the record to `config/cases/{name}.yaml` under this name, with columns as those of"
        " the first one, and run the same command again:",
        "",
        "```yaml",
        "records:",
        f"  {key}:",
        "    file: data/my_new_record.csv",
        "    time: {column: t, units: s}",
        f"    input: {{column: u, units: {units[0]}}}",
        f"    output: {{column: y, units: {units[1]}}}",
        "```",
        "",
        "```",
        f"make resolve NAME={name}",
        "```",
    ]
    return "\n".join(lines) + "\n"
