"""Make the pages of docs/ a site: the README is its home, links out of docs/ become plain text.

Formulas become MathML, which browsers show without a script. Every link is checked on the way, and
the pages once they are built: one that leads nowhere ends the build.
"""

import logging
import posixpath
import re
from html import unescape
from pathlib import Path

from built_pages import faults
from latex2mathml.converter import convert
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
FORMULA = re.compile(
    r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL
)  # as pymdownx.arithmatex leaves it
NOTEBOOK_LINK = re.compile(r'href="([^":#]+\.(?:md|ipynb))(#[^"]*)?"')
SEARCH = "search_frame.js"
log = logging.getLogger("mkdocs")


@event_priority(-100)
def on_config(config):
    """Drop the script from another server that the plugin ``offline`` adds for the search."""
    scripts = config.extra["polyfills"]
    config.extra["polyfills"] = [script for script in scripts if "://" not in script]
    return config


def on_files(files, config):
    """Add the README as the home page; the pictures that it shows are in docs/ already.

    The script by which the search runs without a server comes along.
    """
    script = str(Path(__file__).with_name(SEARCH))
    files.append(File.generated(config, f"assets/{SEARCH}", abs_src_path=script))
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "index.md", content=_rewritten(text, Path("."))))
    return files


def on_page_markdown(markdown, page, config, files):
    """Turn links to files outside of docs/ into their names."""
    if page.file.src_uri == "index.md":
        return markdown
    return _rewritten(markdown, Path("docs", page.file.src_uri).parent)


def on_page_content(html, page, config, files):
    """Turn formulas into MathML, and the links of a notebook into those of the site."""

    def formula(match):
        display = "block" if match[1] == "div" else "inline"
        return convert(unescape(match[2]), display=display)

    def link(match):
        target = files.get_file_from_path(
            posixpath.join(posixpath.dirname(page.file.src_uri), match[1])
        )
        return f'href="{target.url_relative_to(page.file)}{match[2] or ""}"' if target else match[0]

    html = FORMULA.sub(formula, html)
    return NOTEBOOK_LINK.sub(link, html) if page.file.src_uri.endswith(".ipynb") else html


def on_post_build(config):
    """Check the pages as they are."""
    for fault in faults(Path(config.site_dir)):
        log.warning("%s", fault)


def _rewritten(markdown, folder):
    """Return the text, whose links are relative to ``folder`` of the project."""

    def rewrite(match):
        image, label, target, anchor = match.groups()
        if re.match(r"[a-z]+:", target):
            return match[0]
        path = posixpath.normpath(posixpath.join(folder.as_posix(), target))
        if not (ROOT / path).exists():
            log.warning("%s: no file %s", folder, target)
        if path.startswith("docs/") and (ROOT / path).is_file():
            here = "." if folder == Path(".") else folder.relative_to("docs").as_posix()
            inside = posixpath.relpath(path.removeprefix("docs/"), here)
            return f"{image}[{label}]({inside}{anchor or ''})"
        if path.startswith("docs/") and (ROOT / path / "README.md").is_file():
            inside = posixpath.join(path.removeprefix("docs/"), "README.md")
            return f"[{label}]({inside})"
        return label if label.strip("`") == path else f"{label} (`{path}`)"

    return LINK.sub(rewrite, markdown)
