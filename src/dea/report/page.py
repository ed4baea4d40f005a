"""The report from its text, ``workflow/report/report.md``, and the results that this asks for."""

import base64
import io
import re
from collections.abc import Set
from functools import partial
from html import escape, unescape
from pathlib import Path
from types import SimpleNamespace

import jinja2
from docutils.core import publish_parts
from markdown_it import MarkdownIt
from PIL import Image

from dea import provenance
from dea.atomic_file import atomic
from dea.configuration.case import case_files
from dea.errors import InputError
from dea.report.origin import origin, systems, verdict

TEXTS = Path("workflow/report")
CASES = Path("config/cases")
WIDTH = 1500  # pixels, enough for the width of a page
QUALITY = 85  # of a lossy picture, in per cent


def write(file: Path) -> None:
    """Write the report, one file without references to others but links.

    Raises
    ------
    InputError
        If a result that it shows is not what its job made, or its text asks for one that is not
        there.
    """
    environment = jinja2.Environment(undefined=jinja2.StrictUndefined, trim_blocks=True)
    template = environment.from_string((TEXTS / "report.md").read_text(encoding="utf-8"))
    # What is left of a system that has been taken out of the study stays among the results.
    actuators = systems(_result("tables/forecast.md"))
    cases = {path.stem for path in case_files(CASES, ".yaml")}
    text = template.render(
        actuators=sorted(actuators),
        cases=sorted(cases & {*_shown("cases", "fig2_"), *_shown("discrepancy", "")}),
        figure=figure,
        paged_figure=partial(paged_figure, of=actuators),
        table=table,
        verdict=verdict,
        there=_there,
    )
    body = MarkdownIt("commonmark", {"html": True}).enable("table").render(text)
    style = (TEXTS / "report.css").read_text(encoding="utf-8")
    with atomic(file) as unfinished:
        unfinished.write_text(
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>dea-study</title><style>{style}</style></head><body>{body}</body></html>\n",
            encoding="utf-8",
        )


def figure(name: str, system: str = "") -> str:
    """Return the figure ``results/figures/NAME.png`` with its caption and how it was made.

    The caption is that of the last part of the name, without the system's own. Who does not see the
    picture is told its first sentence.
    """
    file = _result(f"figures/{name}.png")
    kind = Path(name).name.removesuffix(f"_{system}").partition("_page")[0]
    if Path(name).parent.name == "discrepancy":
        kind = "discrepancy"
    source = f"data:image/webp;base64,{_small(file)}"
    caption = _caption("figures", kind, system)
    image = f'<img alt="{escape(_first_sentence(caption))}" src="{source}">'
    picture = f'<a href="figures/{name}.pdf">{image}</a>'
    return _framed(picture, caption, file)


def paged_figure(name: str, of: Set[str]) -> str:
    """Return the pages of a figure, one after the other, until all systems ``of`` are on them."""
    pages: list[str] = []
    shown: set[str] = set()
    while not of <= shown:
        page = f"{name}_page{len(pages) + 1}" if pages else name
        pages.append(figure(page))
        shown |= systems(_result(f"figures/{page}.png"))
    return "\n\n".join(pages)


def table(name: str) -> str:
    """Return the table ``results/tables/NAME`` with its caption and how it was made."""
    file = _result(f"tables/{name}.md")
    # Names and units are those of a user's files.
    reader = MarkdownIt("commonmark", {"html": False}).enable("table")
    rows = reader.render(file.read_text(encoding="utf-8"))
    return _framed(f'<div class="wide">{rows}</div>', _caption("tables", name, ""), file)


def _framed(content: str, caption: str, file: Path) -> str:
    # Without blank lines, which would end the HTML within Markdown.
    framed = f"<figure>{content}<figcaption>{caption}{origin(file)}</figcaption></figure>"
    return "\n".join(line for line in framed.splitlines() if line.strip())


def _caption(room: str, name: str, system: str) -> str:
    text = (TEXTS / room / f"{name}.rst").read_text(encoding="utf-8")
    # As Snakemake's own report fills it in.
    wildcards = SimpleNamespace(system=system or "the first actuator")
    filled = jinja2.Template(text).render(snakemake=SimpleNamespace(wildcards=wildcards))
    return str(publish_parts(filled, writer="html5")["fragment"])


def _first_sentence(caption: str) -> str:
    text = unescape(re.sub("<[^>]+>", "", caption))
    return " ".join(text.split()).partition(". ")[0]


def _small(picture: Path) -> str:
    content = io.BytesIO()
    with Image.open(picture) as whole:
        shown = whole.convert("RGB")
        shown.thumbnail((WIDTH, 4 * WIDTH), Image.Resampling.LANCZOS)
        shown.save(content, "WEBP", quality=QUALITY)
    return base64.b64encode(content.getvalue()).decode()


def _there(path: str) -> bool:
    return (provenance.RESULTS / path).exists()


def _result(path: str) -> Path:
    file = provenance.RESULTS / path
    if not file.exists():
        raise InputError("is not there", file=file, remedy="Make it first: make study")
    return file


def _shown(folder: str, begin: str) -> list[str]:
    """Return the systems of which there is the figure that begins so."""
    files = sorted((provenance.RESULTS / "figures" / folder).glob(f"{begin}*.png"))
    return [file.stem.removeprefix(begin) for file in files]
