"""The audit as a page for people."""

from collections import Counter
from collections.abc import Sequence
from datetime import datetime

from dea.audit import quotations
from dea.audit.manifest import Manifest
from dea.audit.verify import Finding, explained, notes, spoilt_by


def page(
    manifest: Manifest, findings: Sequence[Finding], repeated: Sequence[str], begun: datetime
) -> str:
    """Return the audit as Markdown.

    Parameters
    ----------
    repeated
        Products that were made again.
    begun
        When the comparison began.
    """
    commits = Counter(job["run"]["commit"] for job in manifest.jobs.values())
    processors = Counter(job["run"]["processor"] for job in manifest.jobs.values())
    lines = [
        "# Audit of the results",
        "",
        f"**{_verdict(findings)}**",
        "",
        f"{len(manifest.products)} results of {len(manifest.jobs)} jobs were compared with"
        " `results/MANIFEST.json`: their content, the files that each was made from, the code that"
        " made it, and the installed packages.",
        "",
        f"The audit began at {begun.isoformat(timespec='seconds')}. The SHA-256 of the manifest was"
        f" `{manifest.digest}`.",
        "",
        "| made from | jobs |",
        "|---|---|",
        *(f"| commit `{commit}` | {count} |" for commit, count in sorted(commits.items())),
        *(f"| {processor} | {count} |" for processor, count in sorted(processors.items())),
        "",
        *(line for note in notes(manifest) for line in (note, "")),
    ]
    if repeated:
        lines += ["## Made again", "", *(f"- {products}" for products in repeated), ""]
    for finding in findings:
        lines += [f"## {finding.path}", "", f"It {explained(finding, manifest)}", ""]
        resting = spoilt_by(finding, manifest)
        if resting:
            lines += ["Results that rest on it:", "", *(f"- {path}" for path in resting), ""]
        sentences = quotations.resting([finding.path, *resting])
        if sentences:
            lines += ["Sentences that rest on it:", "", *(f"- {line}" for line in sentences), ""]
    return "\n".join(lines)


def _verdict(findings: Sequence[Finding]) -> str:
    if not findings:
        return "Every result is what its job made."
    return (
        f"{len(findings)} findings; the first is {findings[0].path}, which {findings[0].problem}."
    )
