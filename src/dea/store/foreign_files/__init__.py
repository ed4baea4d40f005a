"""Files that other programs write: text tables, spreadsheets, NetCDF, MATLAB, Parquet."""

from dea.store.foreign_files.formats import FORMATS, SeveralSheetsError, read_foreign
from dea.store.foreign_files.table import ForeignTable
from dea.store.foreign_files.time_column import called_time, time_column, units_in_name

__all__ = [
    "FORMATS",
    "ForeignTable",
    "SeveralSheetsError",
    "called_time",
    "read_foreign",
    "time_column",
    "units_in_name",
]
