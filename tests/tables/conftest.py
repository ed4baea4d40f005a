import pandas as pd
import pytest

from dea.tables.table import save


@pytest.fixture
def saved(tmp_path):
    """Save a table and read it back: the CSV as numbers, Markdown and LaTeX as text."""

    def write(table):
        paths = {kind: tmp_path / f"t.{kind}" for kind in ("csv", "md", "tex")}
        save(table, **paths)
        return pd.read_csv(paths["csv"]), paths["md"].read_text(), paths["tex"].read_text()

    return write
