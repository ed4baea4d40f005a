"""Make the pages of docs/ a site: the README is its home, links out of docs/ become plain text.

Every link is checked on the way: one that leads nowhere ends the build.
"""

import logging
import posixpath
import re
from pathlib import Path

from mkdocs.structure.files import File

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
log = logging.getLogger("mkdocs")


def on_files(files, config):
    """Add the README as the home page, and the pictures that it shows are in docs/ already."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "index.md", content=_rewritten(text, Path("."))))
    return files


def on_page_markdown(markdown, page, config, files):
    """Turn links to files outside of docs/ into their names."""
    if page.file.src_uri == "index.md":
        return markdown
    return _rewritten(markdown, Path("docs", page.file.src_uri).parent)


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
