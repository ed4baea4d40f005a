"""Every page of the documentation has a place in the site."""

from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]


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
