"""The notebooks of the documentation, as tests run them."""

import json
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"


def run(name):
    """Run the code of ``docs/NAME.ipynb``; return the names that it leaves."""
    names = {}
    for cell in json.loads((DOCS / f"{name}.ipynb").read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    return names
