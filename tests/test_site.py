"""Every page of the documentation has a place in the site, and its links lead somewhere."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    path
    for kind in ("README.md", "docs/**/*.md", "config/**/*.md", "results/README.md")
    for path in ROOT.glob(kind)
)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


class _Loader(yaml.SafeLoader):
    """Reads tags of mkdocs, which name functions, as nothing."""


_Loader.add_multi_constructor("", lambda loader, suffix, node: None)


def leaves(tree):
    if isinstance(tree, str):
        return [tree]
    branches = tree.values() if isinstance(tree, dict) else tree
    return [leaf for branch in branches for leaf in leaves(branch)]


def test_every_page_is_in_the_navigation():
    settings = yaml.load((ROOT / "mkdocs.yml").read_text(), _Loader)
    named = set(leaves(settings["nav"])) - {"index.md"}
    pages = {
        path.relative_to(ROOT / "docs").as_posix()
        for kind in ("*.md", "*.ipynb", "method/*.md")
        for path in (ROOT / "docs").glob(kind)
    }
    assert named - {"decisions/README.md"} == pages


def anchors(page):
    """The headings of a page as links name them."""
    bare = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", bare, re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_leads_somewhere(page):
    bare = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(), flags=re.DOTALL)
    for link in LINK.findall(bare):
        if re.match("[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link
