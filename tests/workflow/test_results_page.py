"""results/README.md lists what the workflow makes."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "results" / "README.md").read_text(encoding="utf-8")
MADE = [
    (folder, name)
    for folder in ("figures", "tables")
    for name in yaml.safe_load((ROOT / "workflow" / f"{folder}.yaml").read_text(encoding="utf-8"))
]


@pytest.mark.parametrize(("folder", "name"), MADE)
def test_every_figure_and_table_is_listed(folder, name):
    rows = [line for line in PAGE.splitlines() if line.startswith(f"| `{folder}/")]
    listed = {word for row in rows for word in re.findall(r"`([^`]+)`", row.split("|")[1])}
    known = {each.removeprefix(f"{folder}/").removeprefix("actuators/") for each in listed}
    assert (
        {name, f"{name}_NAME"} & known
        or any(each.endswith("…") and name.startswith(each[:-1]) for each in known)
        or f"{name}/NAME" in known
    )
