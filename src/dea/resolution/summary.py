"""What a resolution found, in a few lines of a terminal."""

from dea.provenance import RESULTS
from dea.resolution.rounds import Resolution


def said(name: str, found: Resolution) -> str:
    """Return what a resolution found in a few lines."""
    verdict, count = found.last.verdict, len(found.rounds)
    records = f"{count} designed record{'s' * (count != 1)}"
    lines = [
        f"{name}: {verdict.sentence}",
        f"{found.outcome}: {records}, {found.last.driven:g} s driven.",
    ]
    if found.certificate:
        before, after = found.certificate.before, found.certificate.after
        lines.append(f"On a fresh record: error {before:.3g} to {after:.3g} {verdict.unit}.")
    if found.halted:
        lines.append(found.halted)
    if found.pending is not None:
        lines.append(f"Next: {RESULTS / 'resolve' / name / 'next_experiment.md'}")
    return "\n".join(lines)
