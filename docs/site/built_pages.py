"""What is wrong with pages as they were built: links, addresses of other servers, formulas."""

import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path
from urllib.parse import unquote

LINK = re.compile(r'<[^>]*\b(?:href|src)="([^"]*)"')
LOADED = re.compile(r'<(?:script|img|iframe)\b[^>]*\bsrc="(https?:[^"]*)"')
IDENTIFIER = re.compile(r'\bid="([^"]*)"')
CODE = re.compile(r"<(pre|code|script|style|math)\b.*?</\1>", re.DOTALL)
MATH = re.compile(r"<math\b.*?</math>", re.DOTALL)
FORMULA = re.compile(r"\$[^$<>\n]*[\\^_][^$<>\n]*\$|\\[(\[]")
# Of the theme's scripts, or of the root of a server, as the page for what is not found has them.
ELSEWHERE = ("#__", "javascript:", "data:", "/")


def faults(site: Path) -> Iterator[str]:
    """Yield one line for each fault of the pages of a folder.

    A page must be readable without a network: what it links to within the site is there, what it
    loads is a file of the site, and its formulas are no longer TeX.
    """
    pages = {page: page.read_text(encoding="utf-8") for page in sorted(site.rglob("*.html"))}
    anchors = {page: {unescape(name) for name in IDENTIFIER.findall(pages[page])} for page in pages}
    for page, text in pages.items():
        name = page.relative_to(site)
        for address in LOADED.findall(text):
            yield f"{name}: it loads {address}"
        for link in map(unescape, LINK.findall(CODE.sub("", text))):
            if not link or link.startswith(ELSEWHERE) or re.match("[a-z]+:", link):
                continue
            path, _, anchor = link.partition("#")
            target = (page.parent / unquote(path)).resolve() if path else page
            if not target.exists():
                yield f"{name}: no file {link}"
            elif anchor and target in anchors and unquote(anchor) not in anchors[target]:
                yield f"{name}: no heading {link}"
        if formula := FORMULA.search(CODE.sub("", text)):
            yield f"{name}: the formula {formula[0]} was not converted"
        if any("$" in formula for formula in MATH.findall(text)):
            yield f"{name}: two formulas became one. Put an empty line between them"
