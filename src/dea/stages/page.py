"""Tell what a case found on one page, and in a few lines."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def page(
    settings: Mapping[str, Any],
    sources: list[Path],
    pictures: list[Path],
    page: Path,
    summary: Path,
) -> None:
    """Write ``page.html``, which holds its pictures, and ``summary.txt``."""
    from dea import case_page, store

    findings = case_page.Findings(settings["title"], store.Sources(sources))
    name = findings.name
    images = {
        file.stem.removesuffix(f"_{name}") if file.stem != name else "discrepancy": (
            file.read_bytes()
        )
        for file in pictures
    }
    for path, text in (
        (page, case_page.page(findings, images)),
        (summary, case_page.summary(findings, str(page))),
    ):
        with store.atomic(path) as partial:
            partial.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    run(page, inputs=("sources*", "pictures*"), outputs=("page", "summary"))
