"""Files that other programs write: text tables, spreadsheets, NetCDF, MATLAB, Parquet."""

from dea.store.foreign_files.formats import FORMATS, SeveralSheetsError, read_foreign
from dea.store.foreign_files.table import ForeignTable

__all__ = ["FORMATS", "ForeignTable", "SeveralSheetsError", "read_foreign"]
